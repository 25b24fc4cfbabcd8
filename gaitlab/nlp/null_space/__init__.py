"""Constrained optimisation of black boxes by projections on null spaces (Sovukluk and Ott 2025, Algorithms 1-4)."""
