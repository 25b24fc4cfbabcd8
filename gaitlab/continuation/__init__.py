"""Following solutions along a parameter."""
