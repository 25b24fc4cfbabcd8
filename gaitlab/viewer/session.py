"""A viewing session: one viser server on one output directory, with its controls."""

import io
import logging
import socket
import threading
import time
from collections.abc import Callable
from contextlib import redirect_stdout, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import viser

from ..errors import OutputError
from ..report.result import trial_directories
from .motion import LAYERS, Motion, read_motion
from .playback import SPEEDS, frame_at, playback_of
from .scene import Scene
from .skeleton import Camera, cameras, walking_direction

FRAMES_PER_SECOND = 30.0
"""Of the viewer's display, whatever the recording's rate [Hz]."""
CAMERA_DISTANCE = 3.4  # [m]
FIELD_OF_VIEW = 0.7  # [rad], vertical; shows about 2.5 m at the camera's distance
VIEWS = ("sagittal", "frontal", "oblique")
_LEGEND = "Measured: left red, right blue. Model: orange; its forces purple. Plates: green."
_NOT_CONVERGED = "**NOT CONVERGED**: the model-optimal walk is the last iterate, not a result."


def find_motions(directory: Path) -> dict[str, Motion]:
    """All trials of an output directory that can be shown, by name.

    Raises:
        OutputError: there is none.
    """
    if not directory.is_dir():
        raise OutputError(f"{directory} is not a directory; give the one that 'gaitlab analyse --out' wrote")
    trials = [path for path in trial_directories(directory) if (path / "walk.npz").is_file()]
    motions = [read_motion(path) for path in trials or [directory]]
    return {motion.name: motion for motion in motions}


class Session:
    """A running viewer; does not block. Use as a context manager, or call `close`."""

    def __init__(self, directory: Path, port: int = 8080, host: str = "127.0.0.1") -> None:
        self._motions = find_motions(directory)
        _check_free(host, port)
        # A browser that drops a spare connection would print a traceback.
        logging.getLogger("websockets.server").setLevel(logging.CRITICAL)
        with _quiet():
            self._server = viser.ViserServer(host=host, port=port, label="gaitlab", verbose=False)
        self._lock = threading.RLock()
        self._closed = threading.Event()
        self._follow = True
        self._hidden = set[str]()
        self._set_motion(next(iter(self._motions.values())))
        self._build_controls()
        self._show()
        self._thread = threading.Thread(target=self._run, name="gaitlab-viewer", daemon=True)
        self._thread.start()

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    @property
    def url(self) -> str:
        """Address to open in a browser."""
        return f"http://{self._server.get_host()}:{self._server.get_port()}"

    @property
    def trials(self) -> tuple[str, ...]:
        """Names of the trials to choose from."""
        return tuple(self._motions)

    @property
    def trial(self) -> str:
        """Name of the trial that is shown."""
        return self._motion.name

    @property
    def time(self) -> float:
        """Shown time [s from the first stored frame]."""
        return self._playback.time

    @property
    def speed(self) -> float:
        """Recorded seconds per second of the viewer's clock."""
        return self._playback.speed

    @property
    def frame(self) -> int:
        """Index of the frame that is shown."""
        return frame_at(self._motion.time, self._playback.time)

    @property
    def phase(self) -> str:
        """Name of the phase that is shown; empty if unknown."""
        return self._motion.phase[self.frame] if self._motion.phase else ""

    @property
    def scene(self) -> Scene:
        """Nodes of the trial that is shown."""
        return self._scene

    @property
    def playing(self) -> bool:
        """Whether time goes on by itself."""
        return self._playback.playing

    def play(self, playing: bool = True) -> None:
        """Start or stop."""
        with self._lock:
            self._playback = replace(self._playback, playing=playing)
            self._button.label = "Pause" if playing else "Play"

    def set_speed(self, speed: float) -> None:
        """Recorded seconds per second of the viewer's clock."""
        with self._lock:
            self._playback = replace(self._playback, speed=speed)

    def seek(self, moment: float) -> None:
        """Show the frame at `moment` [s from the first stored frame]."""
        with self._lock:
            self._playback = self._playback.moved_to(moment)
            self._show()

    def set_layer(self, layer: str, visible: bool) -> None:
        """Switch a layer of the scene."""
        with self._lock:
            (self._hidden.discard if visible else self._hidden.add)(layer)
            self._scene.set_visible(layer, visible)

    def set_follow(self, follow: bool) -> None:
        """Keep the pelvis over the middle of the floor, as on a treadmill."""
        with self._lock:
            self._follow = follow
            self._show()

    def select(self, trial: str) -> None:
        """Show another trial, from its start."""
        with self._lock:
            speed = self._playback.speed
            self._scene.remove()
            self._set_motion(self._motions[trial])
            self._playback = replace(self._playback, speed=speed)
            for layer in self._hidden:
                self._scene.set_visible(layer, False)
            self._slider.remove()
            self._slider = self._add_slider()
            self._button.label = "Play"
            self._show()

    def look(self, view: str) -> None:
        """Turn every open browser's camera to a preset."""
        camera = self._camera(view)
        for client in self._server.get_clients().values():
            client.camera.position = camera.position
            client.camera.look_at = camera.target
            client.camera.fov = FIELD_OF_VIEW

    def hide_controls(self) -> None:
        """Fold viser's own controls away: the page around the view has some."""
        self._server.gui.main_panel.minimize()

    def recording(self) -> str:
        """The trial that is shown as one HTML page that plays it and needs nothing else."""
        serializer = self._server.get_scene_serializer()
        with self._lock:
            start, end = self._playback.start, self._playback.end
            for moment in np.arange(start, end, 1.0 / FRAMES_PER_SECOND):
                self.seek(float(moment))
                serializer.insert_sleep(1.0 / FRAMES_PER_SECOND)
        return serializer.as_html()

    def close(self) -> None:
        """Stop the playback and the server."""
        self._closed.set()
        self._thread.join()
        with _quiet():
            self._server.stop()

    def wait(self) -> None:
        """Block until `close` is called or the process is interrupted."""
        self._closed.wait()

    def _set_motion(self, motion: Motion) -> None:
        self._motion = motion
        self._playback = playback_of(motion.time)
        self._server.scene.set_up_direction("+z")
        self._scene = Scene(self._server, motion)
        camera, initial = self._camera("sagittal"), self._server.initial_camera
        initial.position, initial.look_at, initial.fov = camera.position, camera.target, FIELD_OF_VIEW

    def _camera(self, view: str) -> Camera:
        motion = self._motion
        joints = motion.measured if motion.measured is not None else motion.optimal
        points = motion.pelvis if joints is None else joints[self.frame]
        points = points + self._scene.shift(self.frame) if self._follow else points
        return cameras(points, walking_direction(motion.pelvis), CAMERA_DISTANCE)[view]

    def _build_controls(self) -> None:
        gui = self._server.gui
        gui.configure_theme(show_logo=False, show_share_button=False)
        if len(self._motions) > 1:
            trials = gui.add_dropdown("Trial", self.trials)
            trials.on_update(lambda event: self.select(event.target.value))
        self._status = gui.add_markdown("")
        self._button = gui.add_button("Play")
        self._button.on_click(lambda _: self.play(not self.playing))
        speed = gui.add_dropdown("Speed", tuple(SPEEDS), initial_value="1 x")
        speed.on_update(lambda event: self.set_speed(SPEEDS[event.target.value]))
        with gui.add_folder("Layers"):
            for layer in LAYERS:
                self._add_toggle(layer)
            follow = gui.add_checkbox("follow pelvis", True)
            follow.on_update(lambda event: self.set_follow(event.target.value))
        gui.add_markdown(_LEGEND)
        views = gui.add_button_group("Camera", VIEWS)
        views.on_click(lambda event: self.look(event.target.value))
        self._slider = self._add_slider()

    def _add_toggle(self, layer: str) -> None:
        present = any(layer in motion.layers for motion in self._motions.values())
        hint = None if present else "not in these recordings"
        box = self._server.gui.add_checkbox(layer, present, disabled=not present, hint=hint)
        box.on_update(lambda event: self.set_layer(layer, event.target.value))

    def _add_slider(self) -> Any:
        motion = self._motion
        start, end = float(motion.time[0]), float(motion.time[-1])
        step = (end - start) / max(len(motion.time) - 1, 1) or 1.0
        last = end if end > start else start + 1.0
        slider = self._server.gui.add_slider("Time [s]", start, last, step, start, order=0.5)
        slider.on_update(lambda event: self._scrubbed(event.client, event.target.value))
        return slider

    def _scrubbed(self, client: object, moment: float) -> None:
        # Values that the playback itself set come back with no client.
        if client is not None:
            self.seek(moment)

    def _run(self) -> None:
        before = due = time.perf_counter()
        while True:
            # Due times are fixed: a pause after the work would make 30 updates per second 28.
            due = max(due + 1.0 / FRAMES_PER_SECOND, before)
            if self._closed.wait(max(due - time.perf_counter(), 0.0)):
                return
            now = time.perf_counter()
            with self._lock:
                if self._playback.playing:
                    self._playback = self._playback.advanced(now - before)
                    self._show()
            before = now

    def _show(self) -> None:
        with self._server.atomic():
            self._scene.show(self.frame, self._follow)
        moment = float(self._motion.time[self.frame])
        self._slider.value = moment
        lines = [f"**{self.phase or 'phase unknown'}** · {moment:.2f} s"]
        lines += [self._motion.caption] if self._motion.caption else []
        self._status.content = "\n\n".join(lines if self._motion.converged else [_NOT_CONVERGED, *lines])


def _quiet() -> redirect_stdout[io.StringIO]:
    """Keep viser from printing, whatever `verbose` says: only the command line prints."""
    return redirect_stdout(io.StringIO())


def _check_free(host: str, port: int) -> None:
    """Refuse a busy port: viser would silently take the next one, and the printed address would be wrong."""
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except (OSError, OverflowError) as error:
            raise OutputError(f"port {port} on {host} cannot be used ({error}); choose another with --port") from error


def view(
    directory: Path,
    port: int = 8080,
    host: str = "127.0.0.1",
    on_open: Callable[[str], None] | None = None,
) -> None:
    """Show an output directory in the browser until interrupted; `on_open` receives the address.

    Raises:
        OutputError: nothing to show, or the port is busy.
    """
    with suppress(KeyboardInterrupt), Session(directory, port, host) as session:
        if on_open is not None:
            on_open(session.url)
        session.wait()
