"""The command `gaitlab`."""
