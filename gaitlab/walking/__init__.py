"""The gait model as an optimal control problem."""
