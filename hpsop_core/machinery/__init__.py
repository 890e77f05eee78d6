"""The main engine and what it burns; no hydrodynamics and no case data.

``engine`` (layout limits, specific fuel consumption over load) and ``energy_efficiency`` (the IMO's attained EEDI).
"""
