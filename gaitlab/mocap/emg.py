"""Which analogue channels are electromyograms, of which side, and their envelopes."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gaitlab.mocap.recording import Recording, Side
from gaitlab.signal.envelope import linear_envelope

SLOWEST = 400.0  # Hz; slower channels hold no EMG, at most somebody's envelope
_MUSCLES = (
    "RECT|RF|VAST|VL|VM|QUAD|HAM|BICEPS|BF|SEMI|ST|SM|MH|LH|GAS|GAST|MG|LG|SOL|TIB|TA|TP|PER|PL|GLUT|GMAX|GMED|GM|"
    "ADD|ILIO|PSOAS|SART|GRAC|TFL"
)
_NAMED = re.compile(
    rf"^(?:[LR][\s._-]*|LEFT[\s._-]*|RIGHT[\s._-]*)?(?:{_MUSCLES})[A-Z]*(?:[\s._-]+\w+)*$", re.IGNORECASE
)
_SIDE = re.compile(rf"^(L|R|LEFT|RIGHT)(?:[\s._-]+|(?=(?:{_MUSCLES})))", re.IGNORECASE)

MUSCLES: Mapping[str, str] = {
    "rectus_femoris": "RECT(US)?(FEM(ORIS)?)?|RF",
    "medial_hamstrings": "MH|ST|SM|SEMI[A-Z]*|(MED(IAL)?|M)HAM[A-Z]*|HAM[A-Z]*",
    "lateral_hamstrings": "LH|BF|BICEPS[A-Z]*|LAT(ERAL)?HAM[A-Z]*|HAM[A-Z]*LAT[A-Z]*",
    "tibialis_anterior": "TA|TIB|TIB(IALIS)?ANT[A-Z]*|ANT(ERIOR)?TIB[A-Z]*",
    "medial_gastrocnemius": "MG|(MED(IAL)?|M)?GAST?(ROC)?(NEMIUS)?|GAS[A-Z]*MED[A-Z]*",
}
"""Muscles of the usual gait examination to what their labels look like without side, blanks and numbers. Hamstrings and
gastrocnemius of which the label says no more are taken for the medial ones; the first that fits is meant."""


@dataclass(frozen=True, kw_only=True)
class EmgEnvelope:
    """Activity of one muscle."""

    side: Side | None
    """None where the label does not tell."""
    values: np.ndarray
    """Linear envelope in the file's unit, shape (n_samples,)."""
    rate: float
    """Samples per second [Hz]."""


def emg_envelopes(recording: Recording) -> Mapping[str, EmgEnvelope]:
    """Envelopes of all channels that are labelled as EMG or by a muscle and that are not silent, by label."""
    if recording.analog_rate < SLOWEST:
        return {}
    return {
        label: EmgEnvelope(
            side=emg_side(label),
            values=linear_envelope(samples, recording.analog_rate),
            rate=recording.analog_rate,
        )
        for label, samples in recording.analog.items()
        if is_emg(label) and np.isfinite(samples).all() and np.ptp(samples) > 0.0
    }


def is_emg(label: str) -> bool:
    """Whether a label means an electromyogram: 'Sensor 1.EMG1', 'Voltage.L Rect', 'RGAS'."""
    name = _last_part(label)
    return "EMG" in label.upper() or _NAMED.match(name) is not None


def emg_side(label: str) -> Side | None:
    """Side that a label names: 'Voltage.L Rect' is left; None where there is none."""
    found = _SIDE.match(_last_part(label))
    if found is None:
        return None
    return "left" if found[1].upper().startswith("L") else "right"


def emg_muscle(label: str) -> str | None:
    """Muscle (a name of `MUSCLES`) that a label names: 'Voltage.L Rect' is rectus_femoris; None for any other."""
    name = _last_part(label)
    side = _SIDE.match(name)
    plain = re.sub(r"[^A-Z]", "", name[side.end() if side is not None else 0 :].upper())
    lateral_first = sorted(MUSCLES, key=lambda muscle: muscle != "lateral_hamstrings")  # "hamstring lateral" is both
    return next((muscle for muscle in lateral_first if re.fullmatch(MUSCLES[muscle], plain)), None)


def _last_part(label: str) -> str:
    """What follows the device's name: 'Voltage.L Rect' -> 'L Rect'."""
    return label.rpartition(".")[2].strip()
