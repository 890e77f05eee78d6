"""The search: a pure state machine that is asked for designs and told their outcomes. No files, processes or clocks.

* problem: what the algorithm is told of an evaluated design, with failures as infeasible ones
* sampling: the initial sample and the seeds; nsga2: the search at one level
* two_level: the search over two levels of fidelity; generation: what a generation came to
* surface_plan: when level 2 asks its solvers and when a learnt surface
* indicators: how good a front is; decision: choosing one design of it
* families: which designs of a front are one answer, because their errors are greater than their differences
"""
