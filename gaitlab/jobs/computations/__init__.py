"""What each kind of job computes, in a process of its own that knows no database: files in, files out.

One module per kind, so that a process loads only what it needs.
"""
