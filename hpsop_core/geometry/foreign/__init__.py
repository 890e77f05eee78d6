"""Files that only other people's compiled libraries can read, which a damaged file may crash or hang: read apart.

* loose: what a reader gives, and how it travels between processes
* open_cascade: STEP and IGES
* rhino: 3dm
* child: the process that reads one file, bounded in memory and time
* apart: starts it and hears its answer; its death is a refusal of the file
"""
