"""The two gait models of Hatz (2014), chapters 12 and 15, with everything the thesis prints, and our data about them.

`load_case` reads what `gait_benchmark_data.make_case` made: `data/gait_benchmark/NAME.json`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np

from ..errors import NotFound
from ..multibody.presets import thesis_able_bodied_child, thesis_cp_child
from ..multibody.subject import SubjectModel
from ..walking.gait_data import MeasuredGait, PointFootGait
from ..walking.point_foot_gait import GaitLevel
from .bundled import DATA_FOLDERS
from .demo_patterns import ABLE_BODIED_CHILD, CP_CHILD, GaitPattern

NOISE_ANGLE, NOISE_PLACE = np.radians(1.0), 0.01
"""Standard deviations of one unit of noise: angles [rad] and places of the pelvis [m]."""

HOW_CHOSEN = (
    "Given states: a kinematic gait of textbook curves on the thesis's body, standing on one toe at a time, tracked "
    "stage by stage with durations as printed; velocities jump by the law of a rigid inelastic impact. Normalisers: "
    "criteria of that motion. q: optimal for the true weights on a grid twice as fine, driven through DOP853 from "
    "node to node. Made by gaitlab.pipelines.gait_benchmark_data."
)


@dataclass(frozen=True, kw_only=True)
class ThesisGait:
    """What the thesis prints about one of its models, and the pattern that ours starts from."""

    name: str
    title: str
    subject: Callable[[], SubjectModel]
    pattern: Callable[[], GaitPattern]
    speed: float
    """Of our kinematic gait [m/s]."""
    durations: tuple[float, float, float]
    """q_0, q_1, q_2 [s]."""
    n_intervals: tuple[int, int, int]
    weights: np.ndarray
    """gamma, shape (4,)."""
    scalings: np.ndarray
    """gamma^sca, shape (4,)."""
    smoothness: float
    """Weight of normalised squared angular accelerations beside criteria that sum to one: ours."""
    objective: float
    seconds: float
    iterations: int
    n_variables: int
    n_pairs: int
    """Length of the two vectors in the complementarity constraint."""

    @property
    def n_measured(self) -> int:
        """Number of measurement times."""
        return sum(self.n_intervals) + 1


CASES: Mapping[str, ThesisGait] = {
    case.name: case
    for case in (
        ThesisGait(
            name="cp-child",
            title="Child with cerebral palsy, (15.2)-(15.6)",
            subject=thesis_cp_child,
            pattern=lambda: CP_CHILD,
            speed=0.9,
            durations=(3.4100e-01, 3.5125e-01, 7.0494e-02),
            n_intervals=(24, 28, 10),
            weights=np.array([9.9969e-01, 3.1267e-04, 0.0, 0.0]),
            scalings=np.array([1e3, 1e-4, 1.0, 1.0]),
            smoothness=0.05,
            objective=2.4724,
            seconds=6.45074e5,
            iterations=41,
            n_variables=15654,
            n_pairs=8406,
        ),
        ThesisGait(
            name="able-bodied-child",
            title="Able-bodied child, ((15.13), (15.3)-(15.6))",
            subject=thesis_able_bodied_child,
            pattern=lambda: ABLE_BODIED_CHILD,
            speed=1.2,
            durations=(2.4079e-01, 3.7071e-01, 1.2882e-01),
            n_intervals=(35, 60, 20),
            weights=np.array([1.5997e-07, 7.3423e-01, 2.1784e-01, 4.7929e-02]),
            scalings=np.array([1e5, 1e-3, 1e-2, 1e-2]),
            # With 0.05 the swing leg of its long single support turns to the singular angles of knee and ankle.
            smoothness=0.2,
            objective=1.0599,
            seconds=1.10279e6,
            iterations=29,
            n_variables=15654,
            n_pairs=15488,
        ),
    )
}
"""Tables 15.2-15.5 and section 15.2-15.3; the able-bodied problem's number of variables repeats the patient's there."""


@dataclass(frozen=True, kw_only=True)
class GaitCase:
    """A model with its truth."""

    thesis: ThesisGait
    gait: PointFootGait
    weights: np.ndarray
    """True weights of the normalised criteria, on the simplex, shape (4,)."""
    q: tuple[np.ndarray, ...]
    """True coordinates at the nodes of each stage [m, rad], shapes (N_k + 1, n_q)."""
    certificate: Mapping[str, float]

    def measured(self, noise: float, seed: int) -> MeasuredGait:
        """Measurements with normal noise in units of 1 degree and 10 mm; without any they weigh as if it were one."""
        n_q = self.gait.subject.n_q
        deviation = np.where(np.arange(n_q) < 3, NOISE_PLACE, NOISE_ANGLE)
        generator = np.random.default_rng(seed)
        noisy = tuple(q + noise * deviation * generator.standard_normal(q.shape) for q in self.q)
        return MeasuredGait(q=noisy, deviation=(noise or 1.0) * deviation)


class _Stored(msgspec.Struct):
    """The file."""

    how_chosen: str
    weights: list[float]
    normalisers: list[float]
    acceleration_weight: float
    torque_floor: float
    force_weight: float
    states: list[list[list[float]]]
    q: list[list[list[float]]]
    certificate: dict[str, float]


def thesis_gait(name: str) -> ThesisGait:
    """One of `CASES`; raises `errors.NotFound` with the known names."""
    if name not in CASES:
        raise NotFound("gait model", name, CASES)
    return CASES[name]


def load_case(name: str) -> GaitCase:
    """A model of the thesis with our published data. Raises `errors.NotFound` for an unknown name."""
    thesis = thesis_gait(name)
    stored = msgspec.json.decode(_path(name).read_bytes(), type=_Stored)
    gait = PointFootGait(
        name=name,
        subject=thesis.subject(),
        durations=thesis.durations,
        n_intervals=thesis.n_intervals,
        states=np.array(stored.states),
        normalisers=np.array(stored.normalisers),
        acceleration_weight=stored.acceleration_weight,
        torque_floor=stored.torque_floor,
        force_weight=stored.force_weight,
    )
    return GaitCase(
        thesis=thesis,
        gait=gait,
        weights=np.array(stored.weights),
        q=tuple(np.array(q) for q in stored.q),
        certificate=stored.certificate,
    )


def as_json(case: GaitCase) -> bytes:
    """The file of a model; numbers as they are, so that the given states keep every contact exactly."""
    gait = case.gait
    stored = _Stored(
        how_chosen=HOW_CHOSEN,
        weights=case.weights.tolist(),
        normalisers=gait.normalisers.tolist(),
        acceleration_weight=gait.acceleration_weight,
        torque_floor=gait.torque_floor,
        force_weight=gait.force_weight,
        states=gait.states.tolist(),
        q=[np.round(q, 9).tolist() for q in case.q],
        certificate=dict(case.certificate),
    )
    return msgspec.json.encode(stored) + b"\n"


def patient_problem(noise: float = 1.0, seed: int = 0) -> tuple[GaitLevel, GaitCase]:
    """The patient-size inverse problem: lower level with its measurements, and the truth."""
    case = load_case("cp-child")
    return GaitLevel(case.gait, case.measured(noise, seed)), case


def available_cases() -> list[str]:
    """Names of the models whose data are there."""
    return [name for name in CASES if _places(name)]


def _path(name: str) -> Path:
    found = _places(name)
    if not found:
        raise NotFound("data of the gait model", name, available_cases())
    return found[0]


def _places(name: str) -> list[Path]:
    places = [folder / "gait_benchmark" / f"{name}.json" for folder in DATA_FOLDERS]
    return [path for path in places if path.exists()]
