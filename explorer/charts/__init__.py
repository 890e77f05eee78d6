"""Charts of a run that answer to the pointer. How they are drawn stands in ``hpsop_core.charts``.

* ``pareto``: what the Pareto chart shows of a run, and which design a click means.
* ``parallel``: parallel coordinates, and which range a brush means.
* ``scatter``: every design over any two quantities, with colour and size; ``colour_ramp``: a number's colour.
* ``family_cards``: the front's families, a small body plan each.
* ``drivers``: which variables drive which results, as a table.
* ``designs_table``: the table of all designs: rows, order, filter words, HTML and CSV.
"""
