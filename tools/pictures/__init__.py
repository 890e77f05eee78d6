"""The pictures in docs/pictures, each script with the same command line.

* hull, propeller, blade_panels, rankine: shapes and flows; own_files: what `hpsop hull` and `hpsop propeller` draw
* page: the page in each of its states
* command: the command line that they share; shading: a small renderer for them; plotting: matplotlib
"""
