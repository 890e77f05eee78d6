"""Hulls: section patches, the designs derived from them, and the way from a user's table to patches.

A file for a thought: ``hull`` (parent hulls and the hulls of their family), ``form`` (the longitudinal shift that
changes volume and centre of buoyancy), ``hydrostatics``, ``offset_table`` (half-breadths for thin-ship theory),
``panels`` (quadrilaterals for the panel method), ``mesh`` (watertight triangles), ``lines`` (stations, waterlines,
buttocks and profile of a lines plan).

Fitting: ``fit`` (least squares of one patch), ``fit_plan`` (a hull's patches declared, and the loop that fits them),
``table_stations``, ``table_ends`` and ``table_knuckles`` (what a table of half-breadths says), ``table_plans`` (the
patches it is divided into), ``fit_table`` (from a table to a parent hull), ``input`` (from a user's file to a table).
"""
