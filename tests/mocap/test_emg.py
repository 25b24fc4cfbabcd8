from dataclasses import replace

import numpy as np
import pytest
from synthetic_walk import synthetic_walk

from gaitlab.mocap.emg import MUSCLES, emg_envelopes, emg_muscle, emg_side, is_emg


@pytest.mark.parametrize(
    "label", ["Voltage.L Rect", "Voltage.R Tib Ant", "Sensor 1.EMG1", "RGAS", "LHAM", "L_VastLat", "Right Soleus"]
)
def test_muscles_are_found(label):
    assert is_emg(label)


@pytest.mark.parametrize(
    "label", ["Sensor 1.ACCX1", "Raw.Pin 7", "Electric Potential.Fx", "Voltage.L Spare", "channel 12", "Fz1", "Trigger"]
)
def test_other_channels_are_not(label):
    assert not is_emg(label)


@pytest.mark.parametrize(
    ("label", "side"),
    [
        ("Voltage.L Rect", "left"),
        ("RGAS", "right"),
        ("Right Soleus", "right"),
        ("RECTUS", None),
        ("Sensor 1.EMG1", None),
        ("LATERAL", None),
    ],
)
def test_sides(label, side):
    assert emg_side(label) == side


@pytest.mark.parametrize(
    ("label", "muscle"),
    [
        ("Voltage.L Rect", "rectus_femoris"),
        ("RRF", "rectus_femoris"),
        ("Voltage.R Hams", "medial_hamstrings"),
        ("LST", "medial_hamstrings"),
        ("R Ham Lat", "lateral_hamstrings"),
        ("L BicepsFem", "lateral_hamstrings"),
        ("Voltage.L Tib Ant", "tibialis_anterior"),
        ("Voltage.L Tib Post", None),
        ("RGAS", "medial_gastrocnemius"),
        ("RLG", None),
        ("Sensor 1.EMG1", None),
    ],
)
def test_muscles_are_named(label, muscle):
    assert emg_muscle(label) == muscle and (muscle is None or muscle in MUSCLES)


def recorded(samples, rate=1000.0):
    return replace(synthetic_walk(), analog={"Voltage.L Rect": samples, "Force.Fx": samples}, analog_rate=rate)


def test_a_burst_is_an_envelope_in_its_time():
    t = np.arange(4000) / 1000.0
    burst = np.where((t > 1.0) & (t < 2.0), np.sin(2 * np.pi * 90.0 * t), 0.0)
    envelopes = emg_envelopes(recorded(5.0 + burst))  # an offset is no activity
    assert set(envelopes) == {"Voltage.L Rect"}
    values = envelopes["Voltage.L Rect"].values
    assert values[1500] == pytest.approx(2.0 / np.pi, rel=0.05)  # mean of a rectified sine
    assert values[300] == pytest.approx(0.0, abs=0.02) and values.min() >= 0.0


def test_silent_and_slow_channels_are_left_out():
    assert not emg_envelopes(recorded(np.zeros(4000)))
    assert not emg_envelopes(recorded(np.sin(np.arange(400.0)), rate=100.0))
