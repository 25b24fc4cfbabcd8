"""The measured and the optimal walk in 3D."""
