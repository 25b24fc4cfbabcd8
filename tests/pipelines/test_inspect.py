from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from synthetic_walk import synthetic_walk

from gaitlab.pipelines import inspect
from gaitlab.pipelines.inspect import inspect_file


@pytest.fixture
def rows(monkeypatch):
    def describe(recording):
        monkeypatch.setattr(inspect, "read_c3d", lambda path: recording)
        return dict(inspect_file(Path("walk.c3d")).rows)

    return describe


def test_gaps_are_counted_per_marker(rows):
    walk = synthetic_walk()
    hidden = {name: x.copy() for name, x in walk.markers.items()}
    hidden["LHEE"][10:17] = np.nan
    assert rows(replace(walk, markers=hidden))["markers with gaps"] == "LHEE 7"


def test_an_almost_empty_file_is_described_too(rows):
    walk = synthetic_walk()
    described = rows(replace(walk, events=(), parameters={}))
    assert (described["events"], described["body parameters"], described["force plates"]) == ("none", "none", "none")


def test_times_of_events_are_told(rows):
    walk = synthetic_walk()
    first = min(walk.events, key=lambda event: event.time)
    times = rows(walk)["event times"].split(", ")
    assert len(times) == len(walk.events)
    assert times[0] == f"{first.side} {first.kind.replace('_', ' ')} {first.time:.4f}"
