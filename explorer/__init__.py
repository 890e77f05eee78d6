"""The page: what a browser shows of hpsop_core.

A room for a thought, each importing only those before it: ``server`` (viser, made safe, and what comes from a browser),
``state`` (what the page knows), ``charts`` and ``scene`` (drawings, from numbers), ``services`` (runs and designs, by
hpsop_core), ``views`` (what stands in the panels); ``layout`` (where everything stands) and ``app`` (the command and
its server), which ``start`` loads. How a change goes its way through them stands in ``explorer/state/__init__.py``.
"""
