"""Motion-capture recordings: reading, labels, force plates, events and cycles."""
