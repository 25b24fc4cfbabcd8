"""Fixtures of a database, a file store, and a process that computes what a test wants."""

import sys
from pathlib import Path

import pytest
from stored import database, empty_database, store

__all__ = ["database", "empty_database", "store"]


@pytest.fixture
def toy(monkeypatch):
    """Name of the module whose computation is what the job's settings say."""
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parent))
    monkeypatch.setattr(sys, "argv", ["test"])
    return "toy_process"
