"""The paper beside hpsop: its printed tables, a run of its case, and what agrees.

* paper: the printed tables and what follows from them alone
* comparison: every number of a run beside the paper's, as values
* figures: the paper's figures with both; page: the comparison as one HTML file
* own_run: the same tables and figures for a run of any other case
* reproduce: the folder with it and its tables
"""
