"""The 3D side of the page: drawing only, every number of a field comes from the core.

* geometry: meshes of a design in ship axes; transfer: values from a solver's panels onto such a mesh
* pressure: a pressure of the core on the mesh; waves: the water surface as a mesh that an eye takes for water
* colours: colour scales with their legends, and surfaces painted with them
* furniture: what stands on the deck, and the rudder; paint: deck, boot-top, draught marks, shadow; both for looks alone
* nodes: what stands in a browser's scene, moved in place
* surroundings: calm water and sky; camera: where a naval architect stands to look at a ship
"""
