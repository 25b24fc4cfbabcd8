"""Which markers of a trial can be used: swapped or moved ones are found before they bend the fit."""

from collections.abc import Mapping

import numpy as np

from gaitlab.multibody.kinematics import point_positions
from gaitlab.multibody.marker_set import CONVENTIONAL
from gaitlab.multibody.subject import SubjectModel
from gaitlab.signal.runs import valid_rows

SAMPLES = 40
"""Frames, spread over the trial, that medians are taken of."""


def inconsistent_markers(subject: SubjectModel, markers: Mapping[str, np.ndarray], tolerance: float) -> tuple[str, ...]:
    """Markers whose distances to the others of their segment are not those of the model.

    Per segment with at least three markers, the one with the largest median error of its distances is dropped until no
    error exceeds the tolerance; a distance is the median over the frames that show both.

    Args:
        subject: model with markers.
        markers: name to positions [m], shape (n, 3), NaN where missing.
        tolerance: largest error that soft tissue explains [m].
    """
    dropped: list[str] = []
    for s in range(len(subject.segments)):
        names = [name for name, point in subject.markers.items() if point.segment == s and name in markers]
        if len(names) < 3:
            continue
        errors = _distance_errors(subject, markers, names)
        kept = np.ones(len(names), dtype=bool)
        while kept.sum() >= 3:
            own = np.where(kept[:, None] & kept, errors, np.nan)
            typical = np.array([_median(row) for row in own])
            worst = int(typical.argmax())
            if typical[worst] <= tolerance:
                break
            kept[worst] = False
            dropped.append(names[worst])
    return tuple(dropped)


def distant_markers(
    subject: SubjectModel, markers: Mapping[str, np.ndarray], q: np.ndarray, tolerance: float
) -> tuple[str, ...]:
    """Markers whose median distance from the model at known coordinates q (n, n_q) exceeds the tolerance [m].

    Finds what distances cannot, labels of the medial and lateral side of a foot swapped, when q comes from few reliable
    markers, as the direct model's does: these, the conventional ones, are not doubted.
    """
    known = np.flatnonzero(valid_rows(q))
    known = known[:: max(1, len(known) // SAMPLES)]
    if not len(known):
        return ()
    seen = {n: point for n, point in subject.markers.items() if n in markers and n not in CONVENTIONAL}
    model = point_positions(subject, seen, q[known])
    errors = {name: np.linalg.norm(model[name] - markers[name][known], axis=1) for name in seen}
    return tuple(name for name, error in errors.items() if _median(error) > tolerance)


def _distance_errors(subject: SubjectModel, markers: Mapping[str, np.ndarray], names: list[str]) -> np.ndarray:
    """Absolute error of each pair's median distance [m], shape (m, m); NaN on the diagonal and for pairs never seen."""
    y = np.array([markers[name][:: max(1, len(markers[name]) // SAMPLES)] for name in names])
    p = np.array([subject.markers[name].position for name in names])
    distances = np.sort(np.linalg.norm(y[:, None] - y, axis=3), axis=2)  # (m, m, samples), NaN last
    seen = np.isfinite(distances).sum(axis=2, keepdims=True)
    middle = np.take_along_axis(distances, np.maximum(seen - 1, 0) // 2, axis=2)[..., 0]
    errors = np.abs(middle - np.linalg.norm(p[:, None] - p, axis=2))
    np.fill_diagonal(errors, np.nan)
    return errors


def _median(errors: np.ndarray) -> float:
    known = errors[np.isfinite(errors)]
    return float(np.median(known)) if len(known) else 0.0
