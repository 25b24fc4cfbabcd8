import numpy as np
import pytest
from raw_file import raw_recording

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.interpretation import file_events, file_sole_changes, interpret


def marked(times: list[float], labels: list[str], contexts: list[str], minutes: float = 0.0):
    group = {
        "LABELS": tuple(labels),
        "CONTEXTS": tuple(contexts),
        "TIMES": np.array([np.full(len(times), minutes), times]),
    }
    return raw_recording(points=np.ones((300, 1, 3)), first_frame=150, parameters={"EVENT": group})


def events(*columns, **minutes):
    return file_events(marked(*columns, **minutes))


def test_event_times_count_from_the_first_stored_frame():
    found, warnings = events([2.0, 1.6], ["Foot Strike", "Foot Off"], ["Left", "Right"])
    assert [(e.side, e.kind, e.source) for e in found] == [
        ("right", "foot_off", "file"),
        ("left", "foot_strike", "file"),
    ]
    assert [e.time for e in found] == pytest.approx([0.1, 0.5])
    assert warnings == ()


def test_events_outside_the_stored_frames_are_dropped_with_a_warning():
    found, warnings = events([1.0, 2.0, 4.6], ["Foot Strike"] * 3, ["Left"] * 3)
    assert len(found) == 1
    assert warnings == ("2 events of the file lie outside its stored frames and are not used",)


def test_minutes_and_other_events():
    found, _ = events([1.6, 2.0], ["Foot Strike", "Event"], ["Left", "General"], minutes=1.0)
    assert found == ()


def test_changes_of_the_sole_are_no_events_of_the_gait():
    raw = marked([2.0, 1.6, 1.8], ["Heel Rise", "foot flat", "Foot Off"], ["Left", "Right", "Right"])
    assert [e.kind for e in file_events(raw)[0]] == ["foot_off"]
    changes = [(c.side, c.kind, round(c.time, 6)) for c in file_sole_changes(raw)]
    assert changes == [("right", "foot_flat", 0.1), ("left", "heel_off", 0.5)]


def test_more_labels_than_times_give_no_events():
    assert events([1.6], ["Foot Strike"] * 3, ["Left"] * 3) == ((), ())


def test_events_half_a_frame_early_belong_to_the_first_frame():
    found, _ = events([1.496], ["Foot Strike"], ["Left"])
    assert found[0].time == 0.0


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"points": np.empty((0, 2, 3))}, "holds no markers"),
        ({"points": np.empty((5, 0, 3)), "labels": ()}, "holds no markers"),
        ({"labels": ("LHipAngles", "*1")}, "only model outputs"),
        ({"rate": 0.0}, "states no frame rate"),
    ],
)
def test_files_that_cannot_be_used(changes, said):
    with pytest.raises(InvalidRecording, match=said):
        interpret(raw_recording(**changes), "walk", "")


@pytest.mark.parametrize(
    ("unit", "value", "metres", "warned"),
    [("mm", 900.0, 0.9, 0), ("cm", 90.0, 0.9, 0), ("m", 0.9, 0.9, 0), ("", 900.0, 0.9, 1), ("furlong", 0.9, 0.9, 1)],
)
def test_length_units(unit, value, metres, warned):
    parameters = {"POINT": {"UNITS": (unit,)}}
    read = interpret(raw_recording(points=np.full((4, 2, 3), value), parameters=parameters), "walk", "")
    assert read.markers["A"] == pytest.approx(np.full((4, 3), metres))
    assert len(read.warnings) == warned


def test_channels_of_no_plate_are_kept_by_label():
    parameters = {"ANALOG": {"LABELS": ("EMG", "EMG"), "UNITS": ("V", "")}, "POINT": {"UNITS": ("mm",)}}
    read = interpret(raw_recording(parameters=parameters), "walk", "")
    assert set(read.analog) == {"EMG", "EMG (2)", "channel 3"}
    assert read.analog_rate == 200.0 and read.analog_units == {"EMG": "V"}
