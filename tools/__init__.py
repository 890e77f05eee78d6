"""Tools around the project, not installed with it.

* calibrations: what level 1 takes from level 2 in the shipped cases, as files
* case_reference: docs/case.md from the declarations of the fields
* faults: a folder: faults planted one at a time, to see whether the tests notice
* level_ranking: how well level 1 ranks what level 2 judges; error_study: what errors designs have
* fit_dtc: the shipped hull from the offsets of the reference ship; dtc_sections: those offsets, read
* front_choice: whether the front of a run is a choice, or a corner of the box
* hull_campaign: public ships as tables of every kind, read and measured
* licences: docs/licences.md from what is installed; lock: the pins with hashes that `make` installs
* paper_run: docs/paper-run.md and its figures from a run of the paper's case
* pictures: a folder: the pictures of the docs; validation: docs/validation.md and its plots
* docs_site: what the documentation's site has beside docs/; flow_chart: a flow chart as SVG
* chromium: which Chromium shows the page without a screen, and how it starts
"""
