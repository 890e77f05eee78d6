"""Drawings on paper: the lines plan and the propeller drawing, each as one SVG file and one layout of a DXF file.

* paper: a sheet with frame and title block, lines and words in mm, as SVG and DXF
* lines_plan, propeller_drawing: what is on the two sheets
"""
