"""What there is to show of one trial, read from its output directory."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import OutputError
from ..report.colours import side_of
from ..report.result import SOLVED, mapping, read_result
from ..report.walk_file import Walk, read_walk

MARKERS, MEASURED, OPTIMAL = "markers", "measured", "model-optimal"
PLATES, CONTACTS, PRESSURE = "plate forces", "model forces", "pressure centre"
CENTRE, TRAILS, FLOOR = "centre of mass", "trails", "floor"
LAYERS: tuple[str, ...] = (MARKERS, MEASURED, OPTIMAL, PLATES, CONTACTS, PRESSURE, CENTRE, TRAILS, FLOOR)
"""What can be switched on and off."""
TRAIL_SECONDS = 1.0
"""How far back the trails go [s]."""
ARROW_LENGTH = 0.9
"""Length of the arrow of the largest force of a trial [m]."""


@dataclass(frozen=True, kw_only=True)
class Forces:
    """Forces and the points where they act, laboratory frame."""

    origins: np.ndarray
    """[m], shape (n, k, 3); NaN where unknown."""
    vectors: np.ndarray
    """On the person [N], shape (n, k, 3)."""


@dataclass(frozen=True, kw_only=True)
class Motion:
    """One trial in time, laboratory frame, z up; whatever is absent is None or empty."""

    name: str
    time: np.ndarray
    """From the first stored frame [s], shape (n,)."""
    markers: np.ndarray | None
    """[m], shape (n, n_markers, 3); NaN where missing."""
    measured: np.ndarray | None
    """Joints of the measured skeleton [m], shape (n, n_joints, 3)."""
    optimal: np.ndarray | None
    """Joints of the model-optimal skeleton [m], shape (n, n_joints, 3); NaN outside the strides."""
    bones: np.ndarray
    """Pairs of joints, shape (n_bones, 2)."""
    bone_sides: tuple[str | None, ...]
    """Side of each bone; None in the middle."""
    plates: Forces | None
    contacts: Forces | None
    phase: tuple[str, ...]
    """Name of the phase per frame; empty if unknown."""
    centre: np.ndarray | None
    """Centre of mass of the whole body, measured [m], shape (n, 3)."""
    converged: bool
    """False if the document says that the weights, or the prediction, carry no certificate."""
    caption: str = ""
    """What the motion shows besides a measured walk, a sentence; empty for one that was analysed."""

    @property
    def layers(self) -> tuple[str, ...]:
        """Layers that this motion has something for."""
        bones = len(self.bones) > 0
        present = {
            MARKERS: self.markers is not None,
            MEASURED: self.measured is not None and bones,
            OPTIMAL: self.optimal is not None and bones,
            PLATES: self.plates is not None,
            CONTACTS: self.contacts is not None,
            PRESSURE: self.plates is not None,
            CENTRE: self.centre is not None,
            TRAILS: True,
            FLOOR: True,
        }
        return tuple(layer for layer in LAYERS if present[layer])

    @property
    def metres_per_newton(self) -> float:
        """Length of the arrow of 1 N, so that the largest force is 0.9 m long."""
        sizes = [np.linalg.norm(f.vectors, axis=2) for f in (self.plates, self.contacts) if f is not None]
        known = [float(np.nanmax(size)) for size in sizes if np.isfinite(size).any()]
        return ARROW_LENGTH / max([*known, 1.0])

    @property
    def pelvis(self) -> np.ndarray:
        """Way of the root joint, or of the mean marker without a skeleton [m], shape (n, 3)."""
        joints = self.measured if self.measured is not None else self.optimal
        if joints is not None:
            return joints[:, 0]
        if self.markers is None:
            return np.zeros((len(self.time), 3))
        known = np.isfinite(self.markers).all(axis=2, keepdims=True)
        count = known.sum(axis=1)
        total = np.where(known, self.markers, 0.0).sum(axis=1)
        return np.where(count > 0, total / np.maximum(count, 1), np.nan)

    def trails(self, frame: int) -> np.ndarray:
        """Ways of the last second up to a frame, as pieces from frame to frame [m], shape (n_pieces, 2, 3).

        Of the centre of mass, or the pelvis where it is not known, and of what is furthest down on both legs.
        """
        points = [(self.pelvis if self.centre is None else self.centre)[:, None]]
        if self.measured is not None and self.measured.shape[1] > 2:
            # The skeleton's last two points are the tips of the feet.
            points.append(self.measured[:, -2:])
        since = int(np.searchsorted(self.time, self.time[frame] - TRAIL_SECONDS))
        ways = np.concatenate(points, axis=1)[since : frame + 1]
        pieces = np.stack([ways[:-1], ways[1:]], axis=2).reshape(-1, 2, 3)
        return pieces[np.isfinite(pieces).all(axis=(1, 2))]


def read_motion(directory: Path) -> Motion:
    """Read `walk.npz`, and `result.json` for the status, of one trial.

    Raises:
        OutputError: walk.npz is absent, broken, or holds nothing that can be shown.
    """
    walk = read_walk(directory)
    measured, optimal = walk.vectors("segment_positions_measured"), walk.vectors("segment_positions_optimal")
    markers = walk.vectors("markers")
    if measured is None and optimal is None and markers is None:
        raise OutputError(
            f"{directory / 'walk.npz'} holds neither markers nor segment positions, so there is nothing to show; "
            "run 'gaitlab analyse' again"
        )
    converged, caption = _said(directory)
    phase, bones = walk.get("phase"), _bones(walk, measured if measured is not None else optimal)
    names = walk.names("segment_names")
    return Motion(
        name=directory.resolve().name,
        time=walk.time,
        markers=markers,
        measured=measured,
        optimal=optimal,
        bones=bones,
        bone_sides=tuple(side_of(names[end]) if end < len(names) else None for _, end in bones.tolist()),
        plates=_forces(walk.vectors("grf_plates"), walk.vectors("cop_plates")),
        contacts=_contacts(walk, optimal),
        centre=_centre(walk),
        phase=() if phase is None or phase.ndim != 1 else tuple(str(name) for name in phase),
        converged=converged,
        caption=caption,
    )


def _centre(walk: Walk) -> np.ndarray | None:
    centre = walk.numbers("centre_of_mass_measured", 2)
    return None if centre is None or centre.shape != (len(walk.time), 3) else centre


def _said(directory: Path) -> tuple[bool, str]:
    """Whether the document certifies the model's walk, and what it was predicted for."""
    if not (directory / "result.json").is_file():
        return True, ""
    result = read_result(directory)
    converged = result.weights is None or result.weights.converged
    prediction = result.part("prediction")
    if not prediction:
        return converged, ""
    asked, units = mapping(prediction.get("reached")), mapping(prediction.get("units"))
    changes = [f"{name} {value:.4g} {units.get(name, '')}" for name, value in asked.items() if isinstance(value, float)]
    caption = f"Predicted: {', '.join(changes) or 'nothing changed'}; beside it the measured walk at the same phase."
    return converged and prediction.get("status") == SOLVED, caption


def _bones(walk: Walk, joints: np.ndarray | None) -> np.ndarray:
    bones = walk.arrays.get("bones")
    if bones is None or joints is None or bones.ndim != 2 or bones.shape[1] != 2 or bones.dtype.kind not in "iu":
        return np.zeros((0, 2), dtype=int)
    inside = ((bones >= 0) & (bones < joints.shape[1])).all(axis=1)
    return bones[inside].astype(int)


def _forces(vectors: np.ndarray | None, origins: np.ndarray | None) -> Forces | None:
    if vectors is None or origins is None or vectors.shape != origins.shape:
        return None
    return Forces(origins=origins, vectors=vectors)


def _contacts(walk: Walk, optimal: np.ndarray | None) -> Forces | None:
    """Contact forces of the model, at the stored contact points, otherwise at the joints of the same name."""
    forces, stored = walk.vectors("forces_optimal"), walk.vectors("contact_positions_optimal")
    if forces is None or stored is not None:
        return _forces(forces, stored)
    contacts, joints = walk.names("contact_names"), walk.names("segment_names")
    if optimal is None or len(contacts) != forces.shape[1] or len(joints) < optimal.shape[1]:
        return None
    places = [_contact_place(name, joints, optimal) for name in contacts]
    known = [place for place in places if place is not None]
    return _forces(forces, np.stack(known, axis=1)) if len(known) == len(places) else None


def _contact_place(name: str, joints: Sequence[str], optimal: np.ndarray) -> np.ndarray | None:
    """Joint of the contact's name, or the origin of its foot put down to the lowest height of the figure."""
    shown = list(joints)[: optimal.shape[1]]
    if name in shown:
        return optimal[:, shown.index(name)]
    foot = f"{name.split('_')[0]}_foot"
    if foot not in shown:
        return None
    place = optimal[:, shown.index(foot)].copy()
    heights = optimal[..., 2]
    known = heights[np.isfinite(heights)]
    place[:, 2] = np.where(np.isfinite(place[:, 2]), known.min() if known.size else 0.0, np.nan)
    return place
