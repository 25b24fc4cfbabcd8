"""Issue 5, lines 2 and 3: scores beside an independent implementation, plausible scores, time for 200 results."""

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
from gaitlab.clinical.document import Document, write_document
from gaitlab.clinical.gait_profile import VARIABLES, gait_profile, overall_score
from gaitlab.pipelines.analyse import analyse
from gaitlab.pipelines.compare import read_members, write_tables
from gaitlab.pipelines.options import AnalysisOptions
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
