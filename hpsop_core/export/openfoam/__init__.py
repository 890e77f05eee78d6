"""A case for OpenFOAM (the versions of openfoam.com, 1912 and later): the towed hull, and driven by an actuator disc.

* case: the folder with its scripts and what is expected of it
* mesh: the water round the port half, in the proportions of the ship
* flow: fields, properties, schemes, the disc
* dictionary: what every such file begins with
"""
