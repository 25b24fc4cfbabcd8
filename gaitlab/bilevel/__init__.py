"""Inverse optimal control: weights and parameters from measurements."""
