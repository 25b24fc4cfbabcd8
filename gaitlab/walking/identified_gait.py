"""The identified gait as a value: all that a prediction starts from, and how it is kept in a file."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast
from zipfile import BadZipFile

import msgspec
import numpy as np

from ..errors import InvalidRecording, OutputError
from ..multibody.dynamics import layout_of
from ..multibody.subject import SubjectModel
from ..nlp.sparse_solution import SparseSolution, Status, certify
from ..ocp.mechanical import ContactStage
from ..transcription.mechanical_layout import Boundary, ContactRow, MechanicalLayout
from ..transcription.mechanical_problem import MechanicalData, MechanicalProblem, MechanicalStructure
from .criteria import positions
from .identification import WalkOptimum
from .model import ROOT, walking_functions
from .tracking import N_FORCES, MeasuredStride

FILE = "identified.npz"
CERTIFICATE = 1e-6
"""Largest first-order residual with which a stored gait is accepted."""
DATA = ("p", "theta", "acceleration_weights")
SOLUTION = ("w", "s", "lam_g", "lam_c")


@dataclass(frozen=True, kw_only=True, eq=False)
class IdentifiedGait:
    """The optimal walk of one stride with the weights that were found for it."""

    stride: MeasuredStride
    problem: MechanicalProblem
    """The optimal control problem between given states."""
    solution: SparseSolution
    given_nodes: np.ndarray
    """Nodes whose states are given, shape (n_given,)."""
    criteria: tuple[str, ...]
    weights: np.ndarray
    """On the simplex, shape (n_criteria,)."""
    normalisers: np.ndarray
    """What the criteria are divided by, shape (n_criteria,)."""
    heading: float = 0.0
    """Direction of the gait frame in the laboratory [rad]."""

    @property
    def states(self) -> np.ndarray:
        """States at the nodes, shape (N + 1, 2 n_q)."""
        return self.problem.states(self.solution.w)

    @property
    def duration(self) -> float:
        """Stride time [s]."""
        return float(self.stride.times[-1] - self.stride.times[0])

    def raw_weights(self, weights: np.ndarray | None = None) -> np.ndarray:
        """Weights of all criteria as they stand in the problem, floors included, shape (n_all_criteria,).

        For other weights of the gait's criteria, shape (n_criteria,); None: those that were identified.
        """
        raw = self.problem.data.theta
        if weights is None:
            return raw
        shift = np.zeros_like(raw)
        shift[positions(self.criteria)] = (weights - self.weights) / self.normalisers
        return raw + shift

    @property
    def length(self) -> float:
        """Way of the pelvis in the stride [m]."""
        return float(self.states[-1, 0] - self.states[0, 0])


def identified_gait(optimum: WalkOptimum, weights: np.ndarray, heading: float = 0.0) -> IdentifiedGait:
    """The gait of an optimum and its weights, shape (n_criteria,); heading [rad] of the gait frame."""
    return IdentifiedGait(
        stride=optimum.level.tracked.stride,
        problem=optimum.problem,
        solution=optimum.solution,
        given_nodes=optimum.level.given_nodes,
        criteria=optimum.level.settings.criteria,
        weights=weights,
        normalisers=optimum.level.normalisers,
        heading=heading,
    )


class _Described(msgspec.Struct, frozen=True, kw_only=True):
    """What is no array."""

    subject: SubjectModel
    stages: tuple[ContactStage, ...]
    criteria: tuple[str, ...]
    redundant: tuple[ContactRow, ...]
    floor: float
    heading: float
    force_weight: float
    allowance: float
    mu: float
    limited: tuple[int, ...]


def encode_array(value: Any) -> Any:
    """Arrays of any shape (n, ...) as nested lists, for msgspec."""
    if isinstance(value, np.ndarray):
        return cast("np.ndarray", value).tolist()
    raise NotImplementedError(type(value))


def decode_array(kind: type, value: Any) -> Any:
    """Nested lists as arrays of any shape (n, ...), for msgspec."""
    if kind is np.ndarray:
        return np.array(value, dtype=float)
    raise NotImplementedError(kind)


def write_gait(gait: IdentifiedGait, path: Path) -> None:
    """Write `identified.npz`."""
    layout, data = gait.problem.shared.layout, gait.problem.data
    described = _Described(
        subject=gait.stride.subject,
        stages=gait.stride.stages,
        criteria=gait.criteria,
        redundant=tuple(sorted(layout.redundant)),
        floor=gait.stride.floor,
        heading=gait.heading,
        force_weight=data.force_weight,
        allowance=data.allowance,
        mu=gait.solution.mu,
        limited=layout.limited,
    )
    arrays = {name: getattr(data, name) for name in DATA} | {name: getattr(gait.solution, name) for name in SOLUTION}
    arrays |= {"times": gait.stride.times, "reference": gait.stride.reference, "given": data.given}
    arrays |= {"given_nodes": gait.given_nodes, "weights": gait.weights, "normalisers": gait.normalisers}
    text = np.frombuffer(msgspec.json.encode(described, enc_hook=encode_array), dtype=np.uint8)
    try:
        np.savez_compressed(path, allow_pickle=False, described=text, **arrays)
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error


def read_gait(path: Path) -> IdentifiedGait:
    """Read `identified.npz` and certify what it holds anew.

    Raises:
        InvalidRecording: the file is absent, broken, or holds no optimum of this version's model.
    """
    advice = "run 'gaitlab analyse' again with this version"
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        described = msgspec.json.decode(arrays["described"].tobytes(), type=_Described, dec_hook=decode_array)
        gait = _built(described, arrays)
    except FileNotFoundError as error:
        raise InvalidRecording(
            f"{path.parent} holds no identified gait ({path.name}): it is written by 'gaitlab analyse' once the "
            "weights of the criteria are found"
        ) from error
    except (OSError, ValueError, KeyError, EOFError, IndexError, BadZipFile, msgspec.MsgspecError) as error:
        raise InvalidRecording(f"{path} is no identified gait ({error}); {advice}") from error
    if gait.solution.residuals.max() > CERTIFICATE:
        raise InvalidRecording(f"{path} holds no optimum of this model; {advice}")
    return gait


def _built(described: _Described, arrays: dict[str, np.ndarray]) -> IdentifiedGait:
    subject, nodes = described.subject, arrays["given_nodes"]
    stride = MeasuredStride(
        subject=subject,
        stages=described.stages,
        times=arrays["times"],
        reference=arrays["reference"],
        floor=described.floor,
    )
    every = tuple(range(2 * subject.n_q))
    boundary = Boundary(tuple((int(node), every) for node in nodes))
    layout = MechanicalLayout(
        stride.stages, subject.n_q, N_FORCES, ROOT, boundary, described.limited, frozenset(described.redundant)
    )
    structure = MechanicalStructure(layout, walking_functions(layout_of(subject)).functions)
    data = MechanicalData(
        p=arrays["p"],
        theta=arrays["theta"],
        reference=stride.reference,
        tracking=np.zeros_like(stride.reference),
        given=arrays["given"],
        lower=np.full(subject.n_q, -np.inf),
        upper=np.full(subject.n_q, np.inf),
        acceleration_weights=arrays["acceleration_weights"],
        force_weight=described.force_weight,
        allowance=described.allowance,
    )
    problem = MechanicalProblem(structure, data)
    point = _Point(**{name: arrays[name] for name in SOLUTION})
    solution = certify(problem, point, mu=described.mu, iterations=0, status=Status.SOLVED)
    return IdentifiedGait(
        stride=stride,
        problem=problem,
        solution=solution,
        given_nodes=nodes,
        criteria=described.criteria,
        weights=arrays["weights"],
        normalisers=arrays["normalisers"],
        heading=described.heading,
    )


@dataclass(frozen=True, kw_only=True)
class _Point:
    """Primal and dual unknowns."""

    w: np.ndarray
    """Variables, shape (n_w,)."""
    s: np.ndarray
    """Slacks, shape (n_c,)."""
    lam_g: np.ndarray
    """Multipliers, shape (n_g,)."""
    lam_c: np.ndarray
    """Multipliers, shape (n_c,)."""
