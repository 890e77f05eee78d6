"""Charts as SVG: functions from numbers to a ``Plot``, for the page in a browser and for the report on paper alike.

Lowest first; each room uses those above it:

* ``axis``: round ticks, limits with air, linear and logarithmic axes.
* ``marks``: paths of lines and of round, square, starred ... marks; lines without overshoot; how wide a text is.
* ``style``: colours, letters and sizes of the screen and of paper, as the style sheet that every chart is drawn with.
* ``plot``: ``Plot``, which collects lines, bands, marks with error bars and notes on one or two axes, and gives them as
  SVG in a page, as an SVG file of its own, or as CSV.
* ``frame``: what ``Plot`` puts round its area: grid, axes, titles, legend.
* ``looks``: how a design and how published points appear in every chart.
* ``propulsion``: open water, resistance, thrust.
* ``engine``: the engine diagram; ``powering``: power against speed.
* ``hulls``: body plan, sectional areas; ``lines_plan``: body, sheer and half-breadth plan at one scale.
* ``search``: Pareto chart, convergence, evolution of fronts.
* ``own_files``: what was understood of a hull or propeller file, on one ``sheet``; ``raster`` makes a PNG of that.
* ``correlations``: Spearman's rank correlation as a table.

What answers to a pointer (picks, brushes) is the page's own and stands there; here is nothing of a browser or a run.
"""
