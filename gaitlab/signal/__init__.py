"""Filtering, derivatives, gaps and resampling of sampled signals."""
