"""The command ``hpsop``: each handler reads its arguments, asks the Python interface and prints.

* main: the parser of all commands, exit codes; ``python -m hpsop_core.cli`` where nothing is installed
* arguments: what several commands read from their arguments, and how they print
* physics: evaluate, resistance, open-water, validate
* own_files: hull, propeller
* runs: optimize, show; driving: progress on a terminal and Ctrl-C
* export: export, report, reproduce
"""
