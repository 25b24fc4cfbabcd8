"""The viser nodes of one trial, and how they follow a frame."""

from typing import Any

import numpy as np
import viser

from .motion import (
    CENTRE,
    CONTACTS,
    FLOOR,
    LAYERS,
    MARKERS,
    MEASURED,
    OPTIMAL,
    PLATES,
    PRESSURE,
    TRAILS,
    Forces,
    Motion,
)
from .skeleton import Placement, force_arrows, known_points, place_bones, unit_bone

ROOT = "/walk"
COLOURS = {
    MARKERS: (110, 118, 128),
    OPTIMAL: (240, 140, 20),
    PLATES: (20, 130, 90),
    CONTACTS: (190, 80, 160),
    PRESSURE: (20, 130, 90),
    CENTRE: (20, 20, 20),
    TRAILS: (150, 158, 168),
}
SIDE_COLOURS = {"left": (200, 40, 30), "right": (29, 95, 174), None: (62, 72, 84)}
"""Of the measured skeleton."""
_BONE_RADIUS = 0.018  # [m]


class Scene:
    """Nodes of one motion on a viser server; `show` moves them, `set_visible` switches a layer."""

    def __init__(self, server: viser.ViserServer, motion: Motion) -> None:
        self._server, self._motion = server, motion
        self._root = server.scene.add_frame(ROOT, show_axes=False)
        self._nodes = dict[str, Any]()
        self._offset, self._floor = np.zeros(3), np.zeros(3)
        self._visible: dict[str, bool] = dict.fromkeys(LAYERS, True)
        self._filled: dict[str, bool] = dict.fromkeys(LAYERS, True)
        self._add_floor()
        self._add_points(MARKERS, motion.markers, 0.016)
        self._add_bones(MEASURED, motion.measured, None)
        self._add_bones(OPTIMAL, motion.optimal, 0.5)
        self._add_arrows(PLATES, motion.plates)
        self._add_arrows(CONTACTS, motion.contacts)
        self._add_points(CENTRE, motion.centre, 0.05)
        self._add_trails()
        self._add_points(PRESSURE, None if motion.plates is None else motion.plates.origins, 0.035)

    def is_shown(self, layer: str) -> bool:
        """Whether a layer can be seen now: switched on, and something in it at this frame."""
        return layer in self._nodes and bool(self._nodes[layer].visible)

    def set_visible(self, layer: str, visible: bool) -> None:
        """Switch a layer on or off; unknown layers are ignored, because trials differ in what they have."""
        self._visible[layer] = visible
        self._refresh(layer)

    def show(self, frame: int, follow: bool) -> None:
        """Move everything to a frame; with `follow`, keep the pelvis in its place and move the floor.

        The shift is added to the points, not to a parent node: a browser may apply the two at different times.
        """
        motion = self._motion
        self._offset = self.shift(frame) if follow else np.zeros(3)
        self._nodes[FLOOR].position = self._floor + self._offset
        self._move_points(MARKERS, motion.markers, frame)
        self._move_bones(MEASURED, motion.measured, frame)
        self._move_bones(OPTIMAL, motion.optimal, frame)
        self._move_arrows(PLATES, motion.plates, frame)
        self._move_arrows(CONTACTS, motion.contacts, frame)
        self._move_pressure(frame)
        self._move_points(CENTRE, None if motion.centre is None else motion.centre[:, None], frame)
        self._move_trails(frame)

    def shift(self, frame: int) -> np.ndarray:
        """Way on the floor that brings the pelvis to the middle of its path [m], shape (3,)."""
        way = known_points(self._motion.pelvis)
        pelvis = self._motion.pelvis[frame]
        if not np.isfinite(pelvis).all():
            return np.zeros(3)
        return (way.mean(axis=0) - pelvis) * (1.0, 1.0, 0.0)

    def remove(self) -> None:
        """Take all nodes off the server."""
        self._root.remove()

    def _add_floor(self) -> None:
        ways = known_points(self._motion.pelvis)
        middle = ways.mean(axis=0) if len(ways) else np.zeros(3)
        extent = float(np.ptp(ways[:, :2], axis=0).max()) if len(ways) else 0.0
        size = float(np.ceil(extent + 3.0))
        self._floor = np.round(middle) * (1.0, 1.0, 0.0)
        self._nodes[FLOOR] = self._server.scene.add_grid(
            f"{ROOT}/{FLOOR}",
            width=size,
            height=size,
            cell_size=0.25,
            cell_color=(226, 230, 234),
            section_color=(180, 188, 196),
            position=self._floor,
        )

    def _add_points(self, layer: str, points: np.ndarray | None, size: float) -> None:
        if points is None:
            return
        self._nodes[layer] = self._server.scene.add_point_cloud(
            _path(layer),
            points=np.zeros((1, 3), dtype=np.float32),
            colors=COLOURS[layer],
            point_size=size,
            point_shape="circle",
            precision="float32",
        )

    def _add_bones(self, layer: str, joints: np.ndarray | None, opacity: float | None) -> None:
        if joints is None or len(self._motion.bones) == 0:
            return
        mesh, place = unit_bone(), self._bones_at(joints, 0)
        sides = np.array([SIDE_COLOURS[side] for side in self._motion.bone_sides], dtype=np.uint8)
        self._nodes[layer] = self._server.scene.add_batched_meshes_simple(
            _path(layer),
            vertices=mesh.vertices.astype(np.float32),
            faces=mesh.faces.astype(np.uint32),
            batched_wxyzs=place.rotations,
            batched_positions=place.positions,
            batched_scales=place.scales,
            batched_colors=sides if layer == MEASURED else COLOURS[layer],
            opacity=opacity,
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
        )

    def _add_arrows(self, layer: str, forces: Forces | None) -> None:
        if forces is None:
            return
        self._nodes[layer] = self._server.scene.add_arrows(
            _path(layer),
            points=np.zeros((1, 2, 3), dtype=np.float32),
            colors=COLOURS[layer],
            shaft_radius=0.009,
            head_radius=0.022,
            head_length=0.06,
        )

    def _add_trails(self) -> None:
        self._nodes[TRAILS] = self._server.scene.add_line_segments(
            _path(TRAILS), points=np.zeros((1, 2, 3), dtype=np.float32), colors=COLOURS[TRAILS], thickness=0.006
        )

    def _bones_at(self, joints: np.ndarray, frame: int) -> Placement:
        return place_bones(joints[frame] + self._offset, self._motion.bones, _BONE_RADIUS)

    def _move_points(self, layer: str, points: np.ndarray | None, frame: int) -> None:
        if points is None or layer not in self._nodes:
            return
        known = known_points(points[frame])
        if len(known):
            self._nodes[layer].points = (known + self._offset).astype(np.float32)
        self._fill(layer, len(known) > 0)

    def _move_bones(self, layer: str, joints: np.ndarray | None, frame: int) -> None:
        if joints is None or layer not in self._nodes:
            return
        place, node = self._bones_at(joints, frame), self._nodes[layer]
        node.batched_positions = place.positions.astype(np.float32)
        node.batched_wxyzs = place.rotations.astype(np.float32)
        node.batched_scales = place.scales.astype(np.float32)
        self._fill(layer, bool(np.any(place.scales > 0.0)))

    def _move_arrows(self, layer: str, forces: Forces | None, frame: int) -> None:
        if forces is None or layer not in self._nodes:
            return
        scale = self._motion.metres_per_newton
        arrows = force_arrows(forces.origins[frame], forces.vectors[frame], scale)
        if len(arrows):
            self._nodes[layer].points = (arrows + self._offset).astype(np.float32)
        self._fill(layer, len(arrows) > 0)

    def _move_pressure(self, frame: int) -> None:
        plates = self._motion.plates
        if plates is None:
            return
        loaded = force_arrows(plates.origins[frame], plates.vectors[frame], 1.0)
        self._move_points(PRESSURE, loaded[None, :, 0], 0)

    def _move_trails(self, frame: int) -> None:
        pieces = self._motion.trails(frame)
        if len(pieces):
            self._nodes[TRAILS].points = (pieces + self._offset).astype(np.float32)
        self._fill(TRAILS, len(pieces) > 0)

    def _fill(self, layer: str, filled: bool) -> None:
        self._filled[layer] = filled
        self._refresh(layer)

    def _refresh(self, layer: str) -> None:
        if layer in self._nodes:
            self._nodes[layer].visible = self._visible.get(layer, True) and self._filled[layer]


def _path(layer: str) -> str:
    return f"{ROOT}/{layer.replace(' ', '_')}"
