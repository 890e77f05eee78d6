"""Elementary kernels: what sources, dipoles and vortices of unit strength induce. They import nothing of the project.

* source_panels: velocities of flat source panels and of raised point sources (the hull)
* dipole_panels: potentials of dipole and source panels, with the images of the other blades (the propeller)
* vortices: velocities of helical and straight vortices (the lifting line)
"""
