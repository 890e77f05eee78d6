"""Drawings on paper: the lines plan and the propeller drawing, each an SVG file, a layout of a DXF, a page of a PDF.

* paper: a sheet with frame and title block, lines and words in mm, as SVG and DXF; pdf: as PDF
* lines_plan, propeller_drawing: what is on the two sheets
"""
