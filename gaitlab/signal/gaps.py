"""Gaps in marker trajectories: short ones are filled and reported, long ones stay."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from gaitlab.signal.runs import runs, valid_rows

LONGEST = 0.1
"""Longest gap that is filled [s]: 10 frames at 100 Hz, the limit most gait laboratories use for spline filling."""
SUPPORT = 5
"""Valid samples that the spline uses on each side; with fewer than two on a side the gap stays."""


@dataclass(frozen=True, kw_only=True)
class Gap:
    """Missing frames of one marker, between frames where it is seen."""

    marker: str
    start: int
    """First missing frame."""
    end: int
    """First frame after the gap."""
    filled: bool


def fill_gaps(
    markers: Mapping[str, np.ndarray], rate: float, longest: float = LONGEST
) -> tuple[dict[str, np.ndarray], tuple[Gap, ...]]:
    """Fills short gaps with a cubic spline through the samples next to them.

    Args:
        markers: Name to positions [m], laboratory frame, shape (n_frames, 3); NaN where missing.
        rate: Frames per second [Hz].
        longest: Longest gap that is filled [s].

    Returns:
        The markers, and all gaps: those filled and those left (too long, or too little beside them). Frames before a
        marker first appears or after it last does are no gaps; they are never filled.
    """
    filled: dict[str, np.ndarray] = {}
    report: list[Gap] = []
    for name, positions in markers.items():
        filled[name], gaps = _fill_one(name, positions, int(round(longest * rate)))
        report.extend(gaps)
    return filled, tuple(report)


def _fill_one(name: str, x: np.ndarray, longest: int) -> tuple[np.ndarray, list[Gap]]:
    seen = runs(valid_rows(x))
    y = x.copy()
    gaps: list[Gap] = []
    for (before, start), (end, after) in zip(seen, seen[1:], strict=False):
        enough = min(start - before, after - end) >= 2
        short = end - start <= longest
        if short and enough:
            support = np.r_[max(before, start - SUPPORT) : start, end : min(after, end + SUPPORT)]
            y[start:end] = CubicSpline(support, x[support], axis=0)(np.arange(start, end))
        gaps.append(Gap(marker=name, start=start, end=end, filled=short and enough))
    return y, gaps


def describe_gaps(gaps: tuple[Gap, ...], rate: float, names: frozenset[str] | None = None) -> tuple[str, ...]:
    """One sentence on what was filled and one on what was left, for the warnings of a result.

    Args:
        gaps: What `fill_gaps` reported.
        rate: Frames per second [Hz].
        names: Markers that matter; all by default.
    """
    sentences: list[str] = []
    for filled, verb in ((True, "filled"), (False, "left open")):
        chosen = [gap for gap in gaps if gap.filled == filled and (names is None or gap.marker in names)]
        if chosen:
            longest = max(gap.end - gap.start for gap in chosen) / rate
            markers = ", ".join(sorted({gap.marker for gap in chosen}))
            sentences.append(f"{len(chosen)} gaps {verb} in {markers} (longest {longest:.2f} s)")
    return tuple(sentences)
