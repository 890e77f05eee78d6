"""Faults that are planted one at a time into a copy of the tree, to see whether the tests notice: `make faults`.

* ``python -m tools.faults``: plants each and runs the narrow set of tests that should turn red
* the ``.toml`` files: the faults by file, each a small textual patch with the tests that should notice it
"""
