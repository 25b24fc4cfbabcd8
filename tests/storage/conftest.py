"""Fixtures of a database and a file store."""

from stored import database, empty_database, store

__all__ = ["database", "empty_database", "store"]
