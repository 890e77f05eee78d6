"""Between viser and the page: everything that leans on private facts of this very viser.

A file for a thought: ``security`` (a server that only its own user can drive), ``token`` (the secret in its address),
``access`` (who may open it, and what the refused are told), ``notices`` (what the terminal hears of that), ``guard``
(what a browser may say to a widget), ``uploads`` (files that it may send), ``bridge`` (gestures on charts, told to
Python), ``html_slot`` (the one door by which HTML goes to a browser), ``widgets`` (values set from Python),
``visitors`` (who comes and leaves), ``quiet`` (no traces of viser's in the terminal), ``worker`` (a thread that always
does the newest thing asked for), ``process`` (what a serving process asks of Python and the C library), ``wakeups``
(messages from any thread).
"""
