"""A minimal `RawRecording` for tests."""

import numpy as np

from gaitlab.mocap.raw import RawRecording


def raw_recording(**changes) -> RawRecording:
    """One frame, two points, of which the second is missing; any field may be replaced."""
    values = {
        "labels": ("A", "Bé"),
        "points": np.array([[[1.0, 2.0, 3.0], [np.nan, np.nan, np.nan]]]),
        "rate": 100.0,
        "first_frame": 7,
        "analog": np.arange(6.0).reshape(2, 3),
        "analog_rate": 200.0,
        "parameters": {"POINT": {"LABELS": ("A",), "LABELS2": ("B",), "LABELS3": ("C",), "X": np.ones((3, 4, 2))}},
    }
    return RawRecording(**(values | changes))
