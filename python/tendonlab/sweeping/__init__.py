"""Simulations at many points: grids, tables and sampling designs, in parallel, into memory or onto disk."""

from tendonlab.sweeping.designs import latin_hypercube, sobol

__all__ = ["latin_hypercube", "sobol"]
