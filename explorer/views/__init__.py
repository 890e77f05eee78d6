"""What stands in the panels and over the 3D view. Each view draws from the state and none knows another.

Shared by all browsers: ``run_view`` (status and progress), ``settings_view`` with ``settings_fields`` (the case being
set up), ``library_view`` (the folder of runs). One browser's own: ``pareto`` (the live front), ``design_view``,
``charts_view`` with ``chart_tabs``, ``families`` and ``scatter_view``, ``table_view``, ``compare_view``,
``whatif_view``, ``ship_view`` with ``ship_picture`` and ``ship_words`` (the tabs), ``scene_view`` (the ship in 3D),
``overlay_view`` (waves and pressures on it), ``toolbar_view`` (buttons over it), ``screenshot_view`` (it as a file),
``help_view`` with ``help_words`` (the tour and the glossary). Gestures without a picture of their own:
``run_control``, ``parallel_view``. Shared helpers: ``on_display`` (what is selected and overlaid), ``zooming`` (which
part of a chart is seen), ``saving`` (charts as files), ``tables``, ``headline`` and ``chips`` (HTML of numbers, of
what an owner asks first, and of buttons).

A view gets the state (a ``Session``, or the ``AppState``) and of the services what it needs; it draws when the hub
calls it and changes the state by the state's own methods (explorer/state/__init__.py).
"""
