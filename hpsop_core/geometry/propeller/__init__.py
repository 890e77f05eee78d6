"""Propellers: a radial table, the family that grows from it, and its blades and hub as surfaces.

* radial_table: what describes a blade, and how it is read between its rows; input: the same from a user's file
* propeller: parents and their families (diameter, blades, pitch, area)
* sections: thickness and mean line of a blade section; surface: points on the blade from both
* hub: the hub's length and outline, and the fillet at the blades' roots
* nurbs: the blade's surface, which everything stands on, and the hub's; mesh: closed triangle meshes of them
* closed: the blade's surface with sharp edges, for the solvers' panels
"""
