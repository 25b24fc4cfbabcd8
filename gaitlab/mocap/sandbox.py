"""Runs the C3D library in a process of its own, with limits, and turns each of its ends into one sentence.

The parser is native code and the files come from anywhere: it may crash, hang, or ask for all the memory there is.
"""

import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from gaitlab.errors import InvalidRecording
from gaitlab.mocap.header import check_file
from gaitlab.mocap.raw import RawRecording, load_raw

CHILD = "gaitlab.mocap.c3d_child"
OUT_OF_MEMORY = ("MemoryError", "bad_alloc", "Cannot allocate memory", "Unable to allocate")


@dataclass(frozen=True, kw_only=True)
class ReaderLimits:
    """What reading one file may cost. The parser takes 8 bytes per byte of the file."""

    file_size: int = 200_000_000
    """Largest file [bytes]."""
    memory: int = 4_000_000_000
    """Address space of the reading process [bytes]."""
    seconds: float = 60.0
    """Wall and processor time [s]."""


def read_raw(path: Path, limits: ReaderLimits, child: str = CHILD) -> RawRecording:
    """Contents of the C3D file `path`, parsed in a child process.

    Args:
        path: The file.
        limits: Size, memory and time that the file may take.
        child: Module that the child process runs.

    Raises:
        InvalidRecording: The file is no complete C3D file, or the parser refused it, crashed or broke a limit.
    """
    with tempfile.TemporaryDirectory(prefix="gaitlab-") as folder:
        result = Path(folder) / "raw.npz"
        run_child(path, child, (result,), limits)
        try:
            return load_raw(result)
        except (OSError, ValueError, KeyError) as error:
            raise InvalidRecording(f"{path}: the C3D reader returned nothing usable; export the trial again") from error


def run_child(path: Path, child: str, files: Sequence[Path], limits: ReaderLimits) -> None:
    """Let the module `child` work on the C3D file `path`, with more `files` as its arguments, within the limits.

    Raises:
        InvalidRecording: As for `read_raw`.
    """
    check_file(path, limits.file_size)
    command = [sys.executable, "-P", "-m", child, str(path.resolve()), *(str(file.resolve()) for file in files)]
    finished = _run(path, [*command, str(limits.memory), str(limits.seconds)], limits)
    if finished.returncode != 0:
        raise InvalidRecording(f"{path}: {_explain(finished, limits)}")


def _run(path: Path, command: list[str], limits: ReaderLimits) -> "subprocess.CompletedProcess[bytes]":
    environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # threads cost address space
    try:
        return subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=limits.seconds, env=environment, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise InvalidRecording(f"{path}: {_too_slow(limits)}") from error


def _too_slow(limits: ReaderLimits) -> str:
    return f"reading the C3D file took longer than {limits.seconds:g} s and was stopped; export the trial again"


def _explain(finished: "subprocess.CompletedProcess[bytes]", limits: ReaderLimits) -> str:
    lines = finished.stderr.decode("utf-8", "replace").strip().splitlines()
    last = lines[-1] if lines else "no reason given"
    if any(word in line for line in lines[-3:] for word in OUT_OF_MEMORY):
        return f"reading the C3D file needs more than {limits.memory / 1e9:.2g} GB; the file is damaged or too long"
    if finished.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return _too_slow(limits)
    if finished.returncode < 0:
        name = signal.Signals(-finished.returncode).name
        return f"the C3D reader crashed on this file ({name}); the file is damaged, export the trial again"
    reason = last.split(": ", 1)[-1].split(". ", 1)[0].rstrip(".")
    return f"the C3D reader refused the file ({reason}); export the trial again"
