"""Issue 4, peers in one run: gaitlab beside plain casadi.Opti + IPOPT and beside OpenSim Moco, processor time for all.

The program is the tracking of a demo stride: all states free, 24 coordinates, contacts, torques as cost. All start at
the measured motion; Opti solves the identical program, and both stop at 1e-8. Processor time, so that other programs on
the machine do not count; compilation of gaitlab's functions happens once per machine and is reported by itself.
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from demo_stride import demo_stride
from opti_peer import solve_with_opti
from registry import Row, measurement

from gaitlab.inverse.kinematics import coordinate_names
from gaitlab.multibody.dynamics import layout_of
from gaitlab.walking.model import walking_functions
from gaitlab.walking.tracking import MeasuredStride, TrackingSettings, first_guess, track, tracking_problem

CHILD = "demo_able_bodied_child"
REPETITIONS = 3


@measurement(issue=4, line=2)
def beside_plain_opti() -> Iterator[Row]:
    stride, settings = demo_stride(CHILD), TrackingSettings()
    begin = time.process_time()
    walking_functions(layout_of(stride.subject))
    prepared = time.process_time() - begin
    seconds: list[float] = []
    for _ in range(REPETITIONS):
        begin = time.process_time()
        problem = tracking_problem(stride, settings)
        start = first_guess(problem)
        ours = settings.solver.solve(problem, start)
        seconds.append(time.process_time() - begin)
    own = float(np.median(seconds))
    peer = solve_with_opti(problem, layout_of(stride.subject), start)
    theirs = peer.build_seconds + peer.solve_seconds
    apart = abs(peer.f - ours.f) / abs(ours.f)
    yield from (
        Row(quantity="unknowns", value=problem.structure.n_w, limit="", unit="", subject=CHILD),
        Row(quantity="compiled functions loaded", value=prepared, limit="", unit="s", subject=CHILD),
        Row(quantity="gaitlab, processor time", value=own, limit="", unit="s", subject=CHILD),
        Row(quantity="gaitlab, iterations", value=ours.iterations, limit="", unit="", subject=CHILD),
        Row(quantity="Opti + IPOPT, processor time", value=theirs, limit="", unit="s", subject=CHILD),
        Row(quantity="Opti + IPOPT, of it building", value=peer.build_seconds, limit="", unit="s", subject=CHILD),
        Row(quantity="Opti + IPOPT, iterations", value=peer.iterations, limit="", unit="", subject=CHILD),
        Row(quantity="Opti + IPOPT converged", value=float(peer.success), limit=">= 1", unit="", subject=CHILD),
        Row(quantity="ratio of times", value=theirs / own, limit=">= 20", unit="", subject=CHILD),
        Row(quantity="relative difference of optima", value=apart, limit="<= 1e-4", unit="", subject=CHILD),
    )


@measurement(issue=4, line=2)
def beside_moco() -> Iterator[Row]:
    if find_spec("opensim") is None:
        print("  skipped: OpenSim is not installed; pip install opensim")
        return
    stride, seconds = demo_stride(CHILD), list[float]()
    walk = track(stride)
    for _ in range(REPETITIONS):
        begin = time.process_time()
        walk = track(stride)
        seconds.append(time.process_time() - begin)
    own = float(np.median(seconds))
    rms = float(np.sqrt(np.mean((walk.states - stride.reference)[:, 3 : stride.n_q] ** 2)))
    peer = _moco(stride)
    yield from (
        Row(quantity="gaitlab, processor time", value=own, limit="", unit="s", subject=CHILD),
        Row(quantity="gaitlab, rms of angles", value=rms, limit="", unit="rad", subject=CHILD),
        Row(quantity="Moco, processor time", value=peer["seconds"], limit="", unit="s", subject=CHILD),
        Row(quantity="Moco, iterations", value=peer["iterations"], limit="", unit="", subject=CHILD),
        Row(quantity="Moco, rms of angles", value=peer["rms_rad"], limit="", unit="rad", subject=CHILD),
        Row(quantity="Moco converged", value=float(peer["success"]), limit=">= 1", unit="", subject=CHILD),
        Row(quantity="ratio of times", value=peer["seconds"] / own, limit=">= 10", unit="", subject=CHILD),
        Row(quantity="ratio of rms", value=rms / peer["rms_rad"], limit="<= 1.1", unit="", subject=CHILD),
    )


def _moco(stride: MeasuredStride) -> dict[str, float]:
    """What `moco_peer.py` prints; a process of its own, because OpenSim brings its own CasADi."""
    subject, settings = stride.subject, TrackingSettings()
    offsets = np.concatenate([np.zeros(3), *(segment.rotation_offset for segment in subject.segments)])
    problem = {
        "names": coordinate_names(subject),
        "times": (stride.times - stride.times[0]).tolist(),
        "reference": (stride.reference[:, : stride.n_q] + offsets).tolist(),
        "velocities": stride.reference[:, stride.n_q :].tolist(),
        "translation_weight": settings.translation_weight,
        "torque_weight": settings.torque_weight,
        "force_weight": settings.force_weight / (subject.mass * 9.81) ** 2,
        "segments": [asdict(segment) for segment in subject.segments],
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "problem.json"
        path.write_text(json.dumps(problem, default=np.ndarray.tolist))
        command = [sys.executable, str(Path(__file__).with_name("moco_peer.py")), str(path)]
        printed = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout
    found: dict[str, float] = json.loads(printed.splitlines()[-1])
    return found
