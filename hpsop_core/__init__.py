"""hpsop: hydrodynamic optimisation of a ship's hull and propeller as one system. The method, headless."""

from __future__ import annotations

__version__ = "0.1.0"
