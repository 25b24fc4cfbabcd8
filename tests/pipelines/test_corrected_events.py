from dataclasses import replace

import pytest
from synthetic_walk import synthetic_walk

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.events import events_of
from gaitlab.pipelines.analyse import analyse
from gaitlab.pipelines.corrected_events import CorrectedEvent, events_to_use
from gaitlab.pipelines.options import AnalysisOptions


def strike(time_s, side="left"):
    return CorrectedEvent(side=side, kind="foot_strike", time_s=time_s)


def test_corrected_events_are_used_as_they_are_in_time_order():
    walk = synthetic_walk()
    events = events_to_use(walk, {walk.name: (strike(0.9), strike(0.2))}, redetect=True)
    assert [(event.time, event.source) for event in events] == [(0.2, "corrected"), (0.9, "corrected")]


def test_other_walks_keep_theirs():
    walk = synthetic_walk()
    assert events_to_use(walk, {"another": (strike(0.2),)}, redetect=False) == events_of(walk)


@pytest.mark.parametrize("time_s", [-0.1, 1e3, float("nan")])
def test_an_event_outside_of_the_recording_is_refused(time_s):
    walk = synthetic_walk()
    with pytest.raises(InvalidRecording, match="lies outside of the recording"):
        events_to_use(walk, {walk.name: (strike(time_s),)}, redetect=False)


def test_events_of_an_unknown_walk_are_refused():
    walk = replace(synthetic_walk(), name="walk1")
    with pytest.raises(InvalidRecording, match="no walk here; there are walk1"):
        analyse(None, [walk], AnalysisOptions(events={"walk7": ()}))
