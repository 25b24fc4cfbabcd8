"""Gait deviation index (Schwartz & Rozumalski, Gait Posture 28:351, 2008), from a published basis only."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from ..errors import InvalidReference, OutputError
from .gait_profile import VARIABLES

N_FEATURES, N_POINTS = 15, 51
N_ELEMENTS = len(VARIABLES) * N_POINTS
"""459: nine variables at 0, 2 ... 100 % of the cycle."""
ORTHONORMAL = 1e-2
"""Largest deviation of the basis from orthonormal columns, left by rounding in printed workbooks."""


class DeviationBasis(msgspec.Struct, frozen=True, kw_only=True):
    """Features of a large mixed set of strides, and where able-bodied controls lie among them."""

    format: Literal["gaitlab-gdi-1"] = "gaitlab-gdi-1"
    name: str
    source: str
    features: list[list[float]]
    """15 orthonormal gait vectors of 459 elements: singular vectors of the mixed set."""
    control_mean: list[float]
    """Mean feature vector of the controls, 15 elements [deg]."""
    log_distance_mean: float
    """Mean over the controls of ln |feature vector - control_mean|."""
    log_distance_sd: float
    """Its sample standard deviation."""


def read_basis(path: Path) -> DeviationBasis:
    """Read and check a basis written by `write_basis`.

    Raises:
        InvalidReference: The file is absent, or is no basis.
    """
    try:
        basis = msgspec.json.decode(path.read_bytes(), type=DeviationBasis)
    except OSError as error:
        raise InvalidReference(f"GDI basis {path.name} cannot be read ({error.strerror})") from error
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise InvalidReference(f"{path.name} is not a GDI basis of gaitlab: {error}") from error
    check_basis(basis)
    return basis


def write_basis(basis: DeviationBasis, path: Path) -> None:
    """Write a basis as JSON."""
    try:
        path.write_bytes(msgspec.json.encode(basis) + b"\n")
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error


def check_basis(basis: DeviationBasis) -> None:
    """Refuse what cannot be the published basis.

    Raises:
        InvalidReference: Wrong sizes, values that are not finite, or features that are not orthonormal.
    """
    where = f"GDI basis {basis.name}"
    if len(basis.features) != N_FEATURES or any(len(row) != N_ELEMENTS for row in basis.features):
        raise InvalidReference(f"{where}: {N_FEATURES} features of {N_ELEMENTS} elements are needed")
    if len(basis.control_mean) != N_FEATURES:
        raise InvalidReference(f"{where}: the mean of the controls needs {N_FEATURES} elements")
    features = np.array(basis.features)
    numbers = [*basis.control_mean, basis.log_distance_mean, basis.log_distance_sd]
    if not np.all(np.isfinite(features)) or not np.all(np.isfinite(numbers)) or basis.log_distance_sd <= 0.0:
        raise InvalidReference(f"{where}: not all numbers are finite, or the sd of the ln distance is not positive")
    if np.abs(features @ features.T - np.eye(N_FEATURES)).max() > ORTHONORMAL:
        raise InvalidReference(f"{where}: the features are not orthonormal, so this is not the published basis")


def gait_vector(curves: Mapping[str, np.ndarray]) -> np.ndarray | None:
    """The nine curves [deg], shape (101,) each, every 2 % one after the other: shape (459,); None if one is missing."""
    parts = [curves.get(name) for name in VARIABLES]
    known = [part[::2] for part in parts if part is not None and np.all(np.isfinite(part))]
    return np.concatenate(known) if len(known) == len(VARIABLES) else None


def gait_deviation_index(basis: DeviationBasis, curves: Mapping[str, np.ndarray]) -> float | None:
    """GDI = 100 - 10 (ln |F g - c| - m) / s with features F, gait vector g, controls' mean c, m and s of ln distance.

    Args:
        basis: Published basis.
        curves: The nine curves of one side [deg], shape (101,) each.

    Returns:
        100 is the mean of the controls, 10 points are one standard deviation; None when a curve is missing.
    """
    vector = gait_vector(curves)
    if vector is None:
        return None
    distance = float(np.linalg.norm(np.array(basis.features) @ vector - np.array(basis.control_mean)))
    if distance == 0.0:
        return None
    return 100.0 - 10.0 * (float(np.log(distance)) - basis.log_distance_mean) / basis.log_distance_sd
