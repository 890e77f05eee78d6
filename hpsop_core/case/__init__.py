"""A case: everything that the user states.

* fields: how a field is declared, checked and written; sections: every field of every section
* declared_variable: what is said about a design variable; variables: each of them, once, and the space they live in
* case: a case read from TOML, checked, frozen, and written back without loss
"""
