"""What the page knows: state, and the one way it changes.

A file for a thought: ``app_state`` (what all browsers share), ``session`` (what belongs to one of them), ``draft`` (the
case being set up), ``own_ship`` (a ship that is being brought in), ``run_picture`` (a run at one moment), ``shown`` (a
design on display), ``view_options`` (what is drawn in 3D), ``table_options`` (how the table of all designs is shown),
``chart_options`` (what a run's charts show), ``link`` (all of it as an address), ``history`` (steps that can be taken
back); ``hub`` (who wants to know of which change), ``gestures`` (who answers which gesture).

The flow, everywhere on the page: **action -> state -> hub -> views**. A gesture or a widget calls a method of
``Session`` or ``AppState`` (the action), which changes the state and tells the hub which topic changed; the hub calls
the views that draw from that topic, on the browser's own thread. A view assigns nothing in the state, tells no hub and
calls no other view. The state knows no services and no views: what it needs of a run or of physics is handed to it.
"""
