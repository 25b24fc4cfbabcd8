"""Ways to turn complementarity constraints into nonlinear programs that ordinary solvers can solve."""
