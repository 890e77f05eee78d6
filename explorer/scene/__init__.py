"""The 3D side of the page: meshes of a design, camera presets, colours."""
