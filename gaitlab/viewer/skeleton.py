"""Geometry of what is shown, without the viewer: bones as placed cylinders, forces as arrows, cameras."""

from dataclasses import dataclass

import numpy as np

N_SIDES = 12
LEAST_FORCE = 20.0
"""Below this a force is noise of a plate or of the optimiser and has no arrow [N]."""


@dataclass(frozen=True, kw_only=True)
class Placement:
    """Where copies of one mesh stand."""

    positions: np.ndarray
    """Origin of each copy [m], shape (k, 3)."""
    rotations: np.ndarray
    """Unit quaternions (w, x, y, z), shape (k, 4)."""
    scales: np.ndarray
    """Stretch along the mesh's own axes; zero hides a copy, shape (k, 3)."""


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """A closed surface of triangles."""

    vertices: np.ndarray
    """[m], shape (n_v, 3)."""
    faces: np.ndarray
    """Indices of vertices, counter-clockwise from outside, shape (n_f, 3)."""


@dataclass(frozen=True, kw_only=True)
class Camera:
    """A place to look from and the point looked at; z is up."""

    position: np.ndarray
    """[m], shape (3,)."""
    target: np.ndarray
    """[m], shape (3,)."""


def unit_bone() -> Mesh:
    """A tapered cylinder along z from the origin to (0, 0, 1), radius 1 at a third of its length, 0.5 at the ends."""
    angle = 2.0 * np.pi * np.arange(N_SIDES) / N_SIDES
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(N_SIDES)], axis=1)
    rings = [ring * (radius, radius, 0.0) + (0.0, 0.0, z) for radius, z in ((0.5, 0.0), (1.0, 0.3), (0.5, 1.0))]
    bottom, top = 3 * N_SIDES, 3 * N_SIDES + 1
    faces = list[tuple[int, int, int]]()
    for k in range(N_SIDES):
        j = (k + 1) % N_SIDES
        for low in (0, N_SIDES):
            high = low + N_SIDES
            faces += [(low + k, low + j, high + j), (low + k, high + j, high + k)]
        faces += [(bottom, j, k), (top, 2 * N_SIDES + k, 2 * N_SIDES + j)]
    vertices = np.concatenate([*rings, [(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]])
    return Mesh(vertices=vertices, faces=np.array(faces))


def rotation_from_z(directions: np.ndarray) -> np.ndarray:
    """Shortest rotations that turn the z axis into unit directions (k, 3): quaternions (w, x, y, z), shape (k, 4).

    q = (1 + z . d, z x d), normalised; half a turn about x where d = -z.
    """
    x, y, z = directions.T
    quaternions = np.stack([1.0 + z, -y, x, np.zeros_like(x)], axis=1)
    length = np.linalg.norm(quaternions, axis=1, keepdims=True)
    opposite = length[:, 0] < 1e-9
    quaternions[opposite] = (0.0, 1.0, 0.0, 0.0)
    return quaternions / np.where(opposite[:, None], 1.0, length)


def place_bones(points: np.ndarray, bones: np.ndarray, radius: float) -> Placement:
    """Place a unit bone between each pair of points.

    Args:
        points: Joints [m], shape (k, 3); NaN where unknown.
        bones: Pairs of indices of `points`, shape (m, 2).
        radius: Of every bone [m].
    """
    start, end = points[bones[:, 0]], points[bones[:, 1]]
    way = end - start
    length = np.linalg.norm(way, axis=1)
    known = np.isfinite(length) & (length > 0.0)
    direction = np.where(known[:, None], way, (0.0, 0.0, 1.0)) / np.where(known, length, 1.0)[:, None]
    sizes = np.stack([np.full_like(length, radius), np.full_like(length, radius), length], axis=1)
    return Placement(
        positions=np.where(known[:, None], start, 0.0),
        rotations=rotation_from_z(direction),
        scales=np.where(known[:, None], sizes, 0.0),
    )


def known_points(points: np.ndarray) -> np.ndarray:
    """Those of the points [m], shape (k, 3), that are known."""
    return points[np.isfinite(points).all(axis=1)]


def force_arrows(origins: np.ndarray, forces: np.ndarray, metres_per_newton: float) -> np.ndarray:
    """Start and end of an arrow per force of at least 20 N.

    Args:
        origins: Points where the forces act [m], shape (k, 3); NaN where unknown.
        forces: Forces on the person [N], shape (k, 3).
        metres_per_newton: Length of the arrow of 1 N.

    Returns:
        [m], shape (n_arrows, 2, 3).
    """
    size = np.linalg.norm(forces, axis=1)
    shown = np.isfinite(origins).all(axis=1) & np.isfinite(size) & (size >= LEAST_FORCE)
    start = origins[shown]
    return np.stack([start, start + metres_per_newton * forces[shown]], axis=1)


def walking_direction(pelvis: np.ndarray) -> np.ndarray:
    """Unit vector on the floor along the way of the pelvis [m], shape (n, 3); x if it does not move."""
    way = known_points(pelvis)
    step = np.append(way[-1, :2] - way[0, :2], 0.0) if len(way) > 1 else np.zeros(3)
    length = float(np.linalg.norm(step))
    return step / length if length > 1e-3 else np.array([1.0, 0.0, 0.0])


def cameras(points: np.ndarray, forward: np.ndarray, distance: float) -> dict[str, Camera]:
    """Presets around a figure: `sagittal` from the right side, `frontal` from ahead, `oblique` between them.

    Args:
        points: Anything of the figure [m], shape (k, 3).
        forward: Walking direction, a unit vector on the floor, shape (3,).
        distance: From the figure's middle to the camera [m].
    """
    known = known_points(points)
    middle = 0.5 * (known.min(axis=0) + known.max(axis=0)) if len(known) else np.array([0.0, 0.0, 0.8])
    right = np.array([forward[1], -forward[0], 0.0])
    slant = (right + forward) / np.sqrt(2.0)
    places = {"sagittal": right, "frontal": forward, "oblique": slant}
    height = np.array([0.0, 0.0, 0.15 * distance])
    return {name: Camera(position=middle + distance * way + height, target=middle) for name, way in places.items()}
