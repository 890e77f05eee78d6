"""Hydrodynamics: solvers that take a shape and a condition and know of no case.

* friction, michell, kelvin: thin-ship theory: the friction line, the wave resistance, and the waves of its spectrum
* rankine: a folder: wave resistance by Rankine panels (level 2 of the hull)
* open_water: what every propeller solver returns; section_drag: the viscous drag that both share
* lifting_line, blade_panels: a folder each: the propeller's levels 1 and 2
* interaction, operating_point, cavitation: hull and propeller together: wake and thrust deduction, the J at which the
  thrust is met, Keller's criterion
* holtrop: the same by Holtrop and Mennen's regression; powering: the parts of the resistance, efficiencies, powers
* singularities: a folder: the elementary kernels of all panel and vortex methods, which import nothing of the project
"""
