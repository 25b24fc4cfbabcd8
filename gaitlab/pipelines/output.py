"""The files of an analysis: result.json, tables, model, walk."""

import tempfile
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from ..clinical.document import CURVES, SIDES, Document, write_document
from ..errors import OutputError
from ..multibody.urdf import to_urdf
from .analyse import Analysis, TrialAnalysis
from .kinetics import kinetics_columns
from .prediction_source import write_source

JOINTS = ("hip", "knee", "ankle")
ANGLE_DIGITS = 5  # [deg]
METRE_DIGITS = 7
KINETICS_DIGITS = 5  # [N*m/kg, W/kg, %, m]


@contextmanager
def _writing(path: Path) -> Generator[None]:
    try:
        yield
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error


def make_folder(folder: Path) -> None:
    """Make the output folder and try to write into it, before hours of computation depend on it."""
    with _writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass


def write_analysis(analysis: Analysis, folder: Path) -> tuple[Path, ...]:
    """Write everything; returns the folders that hold a result.json, the overall one last."""
    make_folder(folder)
    if len(analysis.trials) == 1:
        write_trial(analysis.trials[0], analysis.document, folder)
        return (folder,)
    folders = tuple(folder / trial.name for trial in analysis.trials)
    for trial, document, own in zip(analysis.trials, analysis.documents, folders, strict=True):
        make_folder(own)
        write_trial(trial, document, own)
    write_document(analysis.document, folder / "result.json")
    return (*folders, folder)


def write_trial(trial: TrialAnalysis, document: Document, folder: Path) -> None:
    """Write the files of one trial into its folder, which exists."""
    time = np.arange(trial.recording.n_frames) / trial.recording.rate
    write_table(folder / "angles.csv", time, angle_columns(trial.kinematics.angles), ANGLE_DIGITS)
    write_table(folder / "joint_centres.csv", time, centre_columns(trial.kinematics.joint_centres), METRE_DIGITS)
    solved = trial.kinetics.kinetics
    if solved is not None:
        write_table(folder / "kinetics.csv", time, kinetics_columns(solved), KINETICS_DIGITS)
    with _writing(folder / "model.urdf"):
        (folder / "model.urdf").write_text(to_urdf(trial.subject), encoding="utf-8")
    with _writing(folder / "walk.npz"):
        np.savez_compressed(folder / "walk.npz", allow_pickle=False, **trial.arrays)
    if trial.weights is not None and trial.weights.gait is not None:
        write_source(trial.weights.gait, trial.constants, folder)
    write_document(document, folder / "result.json")


def angle_columns(angles: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Nine curves of both sides in the order of the contract [deg], shape (n_frames,) each, from angles [rad]."""
    names = [f"{side}_{curve}" for side in SIDES for curve in CURVES]
    return {name: np.degrees(angles[name]) for name in names}


def centre_columns(centres: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """left_hip_x ... right_ankle_z, laboratory frame [m], shape (n_frames,) each, from centres (n_frames, 3)."""
    return {
        f"{side}_{joint}_{axis}": centres[f"{side}_{joint}"][:, number]
        for side in SIDES
        for joint in JOINTS
        for number, axis in enumerate("xyz")
    }


def write_table(path: Path, time: np.ndarray, columns: Mapping[str, np.ndarray], digits: int) -> None:
    """Comma-separated: `time` [s], shape (n,), then the columns, shape (n,) each; NaN becomes an empty cell."""
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(["time", *columns])]
    for moment, row in zip(time, rows, strict=True):
        lines.append(",".join([f"{moment:.6f}", *("" if np.isnan(x) else f"{x:.{digits}f}" for x in row)]))
    with _writing(path):
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
