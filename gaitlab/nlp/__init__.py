"""Nonlinear programs, their solvers and certificates."""
