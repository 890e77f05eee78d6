"""The panel method for propellers in open water (level 2): potentials on blades, hub and wake.

A file for a thought: ``settings`` (panelling and constants), ``grid`` (panels on a blade and its wake), ``hub_grid``,
``potential`` (the factorised integral equation and the Kutta condition), ``forces`` (from circulations or pressures),
``model`` (a propeller's flow, solved at any advance coefficient), ``pressure`` (Cp and the margin against cavitation),
``solver`` (propeller in, open-water result out).
"""
