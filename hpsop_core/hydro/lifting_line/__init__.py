"""The lifting line (level 1 of the propeller): circulation from flow tangency on the chord.

* solver: propeller in, open-water result out
* horseshoes: where the vortices lie and what they induce
* chord_surface: points on the blades' chord surface and the normals there
* thickness: what the blades' thickness does to the flow between them
"""
