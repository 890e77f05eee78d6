"""A case: everything that the user states.

* fields: how a field is declared, checked and written; sections: every field of every section
* variables: the design variables and the space that they live in
* case: a case read from TOML, checked, frozen, and written back without loss
"""
