"""A case: everything that the user states, and what a design is judged by.

* fields: how a field is declared, checked and written; sections: every field of every section, but those of loading
  and engine, which stand in ship
* declared_variable: what is said about a design variable; variables: each of them, once, and the space they live in
* design_numbers: the numbers of a design, of which the next two are made
* objectives: each of them, once; constraints: each of them, once
* own_hull: the hull file that a case names, read once
* ready_case: a case made for a hull that was read
* case: a case read from TOML, checked, frozen, and written back without loss
"""
