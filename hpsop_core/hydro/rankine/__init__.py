"""Wave resistance by Rankine sources, linearised about the double-body flow (level 2 of the hull).

* settings: mesh, domain and momentum planes
* checks: what can give no trustworthy number, refused with the reason
* grid: the cells on the undisturbed surface; operator: the upstream difference on them
* solver: hull and condition in, source strengths out; many_speeds: these at several speeds from one factorisation
* resistance: what the strengths mean: resistance, elevation, sinkage, trim
"""
