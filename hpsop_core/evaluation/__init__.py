"""From a design to its evaluation at a level of fidelity.

The rooms, from the ground up: ``result`` (what an evaluation is), ``levels`` (the two levels and their solvers),
``hull_answer`` and ``propeller_answer`` (what the solvers answer, remembered apart from each other),
``hull_propulsion`` (allowances, wake, thrust deduction and eta_R as the case wants them), ``shapes`` (hull and
propeller of a design, V0), ``ship`` (weights, stability, engine, EEDI), ``condition`` (one operating condition),
``gaussian_process``, ``surface`` and ``learnt_back`` (what a learnt surface answers for the solvers),
``propeller_tables`` (level 1's propellers of a search), ``wave_correction`` (level 1 taught by level 2),
``shipped_calibration`` (what level 1 takes from level 2 in the shipped cases, kept as files), ``physics`` (every
number of a design, not normalised), ``reference`` (the initial design's, which normalise), ``solvable`` (which levels
a new case can be solved at), ``curves`` and ``power_curves`` (what is drawn beyond an evaluation), ``coverage`` (what
"feasible" covers), ``evaluate``, which puts them together with the objectives and constraints that ``case`` declares,
``first_start`` (kernels compiled once), ``input_widths`` (how sure k and wake are), ``errors`` (how sure a design's
numbers are, from finer solutions), ``stated_errors`` (typical ones where there are none), ``fields`` (the waves and
the pressures of a design), and beside it what a towing tank and an open-water test are asked: ``resistance`` and
``open_water``, of a design or of a hull or propeller at hand.
"""
