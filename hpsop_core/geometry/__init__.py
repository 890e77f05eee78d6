"""Shapes: hulls and propellers as smooth surfaces, without any physics and without a case.

* hull, propeller: a folder each, from a table to patches, panels and meshes
* foreign: files of CAD systems, which only others' libraries read, in a process apart
* nurbs: the surfaces that both are made of
* clearance: where the propeller stands behind the hull, and how far its blades stay clear of it
* room_for_propeller: where one finds room behind a hull whose file tells neither shaft nor boss
* delimited_text: tables as text, whatever their separators, decimal marks and encoding
* from_files: a hull or a propeller from a user's file, ready to be computed
* analytic_bodies: panels of bodies whose flow is known in closed form
"""
