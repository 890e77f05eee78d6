"""Services: what stands between the page and hpsop_core.

A file for a thought: ``services`` (all in one piece), ``designs`` (numbers, curves, shapes and fields of a design of
the run on display), ``answers`` (the same for any case, without a page), ``remembered`` (the cache they share),
``runs`` (start, open, control, extend, delete), ``refining`` (errors when asked), ``run_keeper`` (one run file and its
controller), ``library`` (the folder of runs), ``own_ships`` (a ship of the user's own, read and made the case),
``reading`` (the process that reads its files), ``reading_process`` and ``reading_job`` (what runs in it),
``page_memory`` (what a restart brings back); ``run_labels`` (a run's name and note), ``reports`` (a run's report, made
by a process of its own); ``display`` (the little that services may see and do of the state).

Services never meet a view: what changes, they show on the ``Display``, and the state's hub tells the views.
"""
