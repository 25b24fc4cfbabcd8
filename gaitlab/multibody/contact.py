"""Points of the sole that may touch the floor."""

from collections.abc import Mapping

import numpy as np

from gaitlab.errors import InvalidSubject

FLAT_SHARE = 0.1
"""Share of the frames, those with heel and toe lowest, that count as foot flat: all frames of a static look alike, and
in a walk it is the middle of stance."""

MARKER_ABOVE_FLOOR = 0.025
"""Height of the lowest foot marker above the floor [m] where the floor is not at zero: a marker's radius and the foot's
tissue or the shoe's sole under the toe."""


def flat_frames(markers: Mapping[str, np.ndarray], side: str) -> np.ndarray:
    """Indices of the frames in which the foot (`left` or `right`) is flat, from heel and toe marker heights [m]."""
    letter = side[0].upper()
    heights = markers[f"{letter}HEE"][:, 2] + markers[f"{letter}TOE"][:, 2]
    known = np.flatnonzero(np.isfinite(heights))
    if not len(known):
        raise InvalidSubject(
            f"No frame shows {letter}HEE and {letter}TOE together; both are needed for the {side} sole."
        )
    lowest = known[np.argsort(heights[known], kind="stable")]
    return np.sort(lowest[: max(1, round(FLAT_SHARE * len(known)))])


def sole_points(markers: Mapping[str, np.ndarray], side: str, floor: float) -> dict[str, np.ndarray]:
    """Heel and toe marker dropped to the height of the floor [m], shapes (n, 3); of use where the foot is flat."""
    letter = side[0].upper()
    points = {"heel": markers[f"{letter}HEE"].copy(), "toe": markers[f"{letter}TOE"].copy()}
    for point in points.values():
        point[:, 2] = floor
    return points


def floor_height(markers: Mapping[str, np.ndarray]) -> float:
    """Height of the floor under heel and toe markers [m]: zero unless they never come near it.

    The laboratory's zero is the floor when the lowest marker stands 0 to 0.12 m above it; else (a raised plate, a
    shifted origin) the floor lies `MARKER_ABOVE_FLOOR` below.
    """
    names = [letter + name for letter in "LR" for name in ("HEE", "TOE") if letter + name in markers]
    heights = [markers[name][:, 2] for name in names]
    seen = [z[np.isfinite(z)] for z in heights if np.isfinite(z).any()]
    if not seen:
        raise InvalidSubject("No heel or toe marker (LHEE, RHEE, LTOE, RTOE) is seen; the floor cannot be found.")
    lowest = float(min(np.percentile(z, 2) for z in seen))
    return 0.0 if 0.0 <= lowest <= 0.12 else lowest - MARKER_ABOVE_FLOOR
