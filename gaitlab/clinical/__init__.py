"""Clinical quantities and the result document."""
