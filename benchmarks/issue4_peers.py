"""Issue 4, peers in one run: the same program by gaitlab and by plain casadi.Opti + IPOPT, processor time for both.

The program is the tracking of a demo stride: all states free, 24 coordinates, contacts, torques as cost. Both start at
the measured motion and stop at 1e-8. Processor time, so that other programs on the machine do not count; compilation
of gaitlab's functions happens once per machine and is reported by itself.
"""

import time
from collections.abc import Iterator

import numpy as np
from demo_stride import demo_stride
from opti_peer import solve_with_opti
from registry import Row, measurement

from gaitlab.multibody.dynamics import layout_of
from gaitlab.walking.model import walking_functions
from gaitlab.walking.tracking import TrackingSettings, first_guess, tracking_problem

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
