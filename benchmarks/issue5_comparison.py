"""Issue 5, lines 2 and 3: distances, times, scores beside plain arithmetic, plausible scores, time for 200 results."""

import math
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
from registry import CHILDREN, Row, measurement
from synthetic_output import document
from vicon import recording

from gaitlab.clinical.comparison import compare
from gaitlab.clinical.document import SIDES, Document, write_document
from gaitlab.clinical.gait_profile import VARIABLES, gait_profile, overall_score
from gaitlab.inverse.conventional import joint_kinematics
from gaitlab.inverse.static import calibrate_subject
from gaitlab.mocap.cycle import Cycle
from gaitlab.mocap.cycles import cycles
from gaitlab.mocap.recording import Recording
from gaitlab.pipelines.analyse import analyse
from gaitlab.pipelines.compare import read_members, write_tables
from gaitlab.pipelines.options import AnalysisOptions
from gaitlab.pipelines.trial import trial_spatiotemporal
from gaitlab.report.comparison_figures import figures

N_RESULTS = 200


@measurement(issue=5, line=2)
def scores_beside_plain_arithmetic() -> Iterator[Row]:
    rng = np.random.default_rng(0)
    worst = 0.0
    for _ in range(20):
        reference, left, right = ({name: rng.normal(10.0, 15.0, 101) for name in VARIABLES} for _ in range(3))
        by_hand = [_variable_scores(curves, reference) for curves in (left, right)]
        profiles = [gait_profile(curves, reference) for curves in (left, right)]
        overall = _rms([*by_hand[0].values(), *(by_hand[1][name] for name in VARIABLES[3:])])
        worst = max(worst, abs((overall_score(*profiles) or 0.0) - overall))
        for profile, expected in zip(profiles, by_hand, strict=True):
            worst = max(worst, *(abs(profile.gvs[name] - expected[name]) for name in VARIABLES))
            worst = max(worst, abs((profile.gps or 0.0) - _rms(list(expected.values()))))
    yield Row(quantity="GVS, GPS", value=worst, limit="<= 1e-9", unit="deg", subject="20 made-up gaits")


def _variable_scores(curves, reference) -> dict[str, float]:
    return {
        name: _rms([float(a - b) for a, b in zip(curves[name], reference[name], strict=True)]) for name in VARIABLES
    }


def _rms(values: list[float]) -> float:
    return math.sqrt(sum(value * value for value in values) / len(values))


@measurement(issue=5, line=2)
def spatiotemporal_beside_plain_arithmetic() -> Iterator[Row]:
    walks = [f"children/{child}/{kind}_*.c3d" for child in CHILDREN for kind in ("straight", "turn")]
    for pattern in (*walks, "fmc_adult/*BP06.c3d", "fmc_adult/*BP15.c3d"):
        walk = recording(pattern)
        found = {side: cycles(walk.events, side) for side in SIDES}
        if not any(found.values()):  # two of the turns hold no whole stride
            continue
        kinematics = joint_kinematics(walk, calibrate_subject(None, walk, {}))
        ours = trial_spatiotemporal(walk, kinematics, found)
        pairs = [(cycle, values) for side in SIDES for cycle, values in zip(found[side], ours[side], strict=True)]
        worst = max(
            _distance(getattr(values, name), expected)
            for cycle, values in pairs
            for name, expected in _spatiotemporal(walk, cycle).items()
        )
        words = f"distances and times of {len(pairs)} cycles"
        yield Row(quantity=words, value=worst, limit="<= 1e-6", unit="", subject=walk.name)


def _distance(value: float | None, expected: float) -> float:
    """Between two numbers; none where both are unknown, infinite where one is."""
    if value is None or math.isnan(expected):
        return 0.0 if value is None and math.isnan(expected) else math.inf
    return abs(value - expected)


def _spatiotemporal(walk: Recording, cycle: Cycle) -> dict[str, float]:
    """What the events and the heels give by school arithmetic, point by point; nothing without all events."""
    off, other_off, other_strike = cycle.foot_off, cycle.opposite_foot_off, cycle.opposite_foot_strike
    if off is None or other_off is None or other_strike is None:
        return {}
    own, other = ("LHEE", "RHEE") if cycle.side == "left" else ("RHEE", "LHEE")
    (x0, y0), (x1, y1) = (_heel(walk, own, time) for time in (cycle.start, cycle.end))
    x2, y2 = _heel(walk, other, other_strike)
    seconds = cycle.end - cycle.start
    length = math.hypot(x1 - x0, y1 - y0)
    single = 100.0 * (other_strike - other_off) / seconds
    stance = 100.0 * (off - cycle.start) / seconds
    return {
        "stride_time_s": seconds,
        "stride_length_m": length,
        "speed_m_per_s": length / seconds,
        "cadence_steps_per_min": 2.0 * 60.0 / seconds,
        "step_time_s": cycle.end - other_strike,
        "step_length_m": ((x1 - x2) * (x1 - x0) + (y1 - y2) * (y1 - y0)) / length,
        "step_width_m": abs((x1 - x0) * (y1 - y2) - (y1 - y0) * (x1 - x2)) / length,
        "foot_off_percent": stance,
        "stance_percent": stance,
        "swing_percent": 100.0 - stance,
        "opposite_foot_off_percent": 100.0 * (other_off - cycle.start) / seconds,
        "opposite_foot_strike_percent": 100.0 * (other_strike - cycle.start) / seconds,
        "single_support_percent": single,
        "double_support_percent": stance - single,
    }


def _heel(walk: Recording, marker: str, time: float) -> tuple[float, float]:
    """Place on the floor [m] at a time [s], on the straight line between the frames beside it."""
    frame = min(int(time * walk.rate), walk.n_frames - 2)
    part = time * walk.rate - frame
    (x0, y0, _), (x1, y1, _) = walk.markers[marker][frame], walk.markers[marker][frame + 1]
    return float(x0 + part * (x1 - x0)), float(y0 + part * (y1 - y0))


@measurement(issue=5, line=2)
def scores_of_able_bodied_children() -> Iterator[Row]:
    for child in CHILDREN:
        static, walk = (recording(f"children/{child}/{kind}_*.c3d") for kind in ("static", "straight"))
        scores = analyse(static, [walk], AnalysisOptions(weights=False)).document.scores
        overall = math.nan if scores is None or scores.gps_overall is None else scores.gps_overall
        yield Row(
            quantity="GPS overall (3.4 to 8.7 expected)", value=overall, limit="<= 8.7", unit="deg", subject=child
        )


@measurement(issue=5, line=3)
def comparison_of_many_results() -> Iterator[Row]:
    static, walk = (recording(f"children/{CHILDREN[0]}/{kind}_*.c3d") for kind in ("static", "straight"))
    real = analyse(static, [walk], AnalysisOptions(weights=False)).document
    weights = msgspec.convert(document(), Document).weights
    written = msgspec.structs.replace(real, weights=weights)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number in range(N_RESULTS):
            (folder / f"result{number}").mkdir()
            write_document(written, folder / f"result{number}" / "result.json")
        arguments = [f"group{number % 4}={folder / f'result{number}'}" for number in range(N_RESULTS)]
        start, used = time.perf_counter(), time.process_time()
        members, _ = read_members(arguments)
        comparison = compare(members)
        write_tables(comparison, folder)
        drawn = figures(comparison)
        seconds, used = time.perf_counter() - start, time.process_time() - used
    yield Row(quantity="read, tables, figures", value=seconds, limit="<= 5", unit="s", subject=f"{N_RESULTS} results")
    yield Row(quantity="processor time", value=used, limit="<= 5", unit="s", subject=f"{N_RESULTS} results")
    yield Row(quantity="figures", value=float(len(drawn)), limit=">= 4", unit="", subject=f"{N_RESULTS} results")
