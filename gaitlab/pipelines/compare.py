"""Folders of results in, tables out."""

import csv
import importlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import msgspec

from ..clinical.comparison import MINIMAL, Comparison, Member, MinimalDifference, Table, tables
from ..clinical.document import read_document
from ..errors import InvalidRecording, OutputError

RESULT = "result.json"
_FIRST_SAMPLE = "p0"


def read_members(arguments: Sequence[str]) -> tuple[tuple[Member, ...], tuple[str, ...]]:
    """Read the results of folders, each given as `DIR` or as `GROUP=DIR`.

    Returns:
        The results, labelled by the ends of their paths, and why others could not be read.

    Raises:
        InvalidRecording: None could be read.
    """
    parts = [_split(argument) for argument in arguments]
    labels = _labels([folder for _, folder in parts])
    members: list[Member] = []
    problems: list[str] = []
    for (group, folder), label in zip(parts, labels, strict=True):
        try:
            members.append(Member(label=label, group=group or label, document=read_document(folder / RESULT)))
        except InvalidRecording as error:
            problems.append(f"{label} left out: {error}")
    if not members:
        raise InvalidRecording("; ".join(problems) or "nothing to compare: name at least one folder of results")
    return tuple(members), tuple(problems)


def read_minimal(path: Path) -> dict[str, MinimalDifference]:
    """Minimal differences from a CSV with the columns quantity, value and source, added to the built-in ones."""
    found = dict(MINIMAL)
    try:
        with path.open(newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                found[row["quantity"]] = MinimalDifference(value=float(row["value"]), source=row["source"])
    except OSError as error:
        raise InvalidRecording(f"{path} cannot be read ({error.strerror})") from error
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidRecording(f"{path}: the columns quantity, value and source are needed ({error})") from error
    return found


def write_tables(comparison: Comparison, folder: Path, parquet: bool = False) -> tuple[Path, ...]:
    """Write every table as CSV, and as Parquet if asked for; returns the files.

    Raises:
        OutputError: The folder cannot be written, or Parquet is asked for and pyarrow is not installed.
    """
    writers: list[tuple[str, Callable[[Table, Path], None]]] = [(".csv", _write_csv)]
    if parquet:
        writers.append((".parquet", _write_parquet))
    written: list[Path] = []
    for name, table in tables(comparison).items():
        for ending, write in writers:
            path = folder / f"{name}{ending}"
            try:
                write(table, path)
            except OSError as error:
                raise OutputError(f"{path} cannot be written ({error.strerror})") from error
            written.append(path)
    return tuple(written)


def _write_csv(table: Table, path: Path) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table.columns)
        if _FIRST_SAMPLE not in table.columns:
            writer.writerows(table.rows)
            return
        # Samples of curves are many: JSON writes numbers ten times as fast as csv does.
        start = table.columns.index(_FIRST_SAMPLE)
        head = csv.writer(file, lineterminator=",")
        for row in table.rows:
            head.writerow(row[:start])
            file.write(msgspec.json.encode(row[start:])[1:-1].decode().replace("null", "") + "\n")


def _write_parquet(table: Table, path: Path) -> None:
    try:
        arrow: Any = importlib.import_module("pyarrow")
        writer: Any = importlib.import_module("pyarrow.parquet")
    except ImportError as error:
        raise OutputError("Parquet needs pyarrow: pip install 'gaitlab[parquet]', or leave --parquet away") from error
    columns = {name: [row[k] for row in table.rows] for k, name in enumerate(table.columns)}
    writer.write_table(arrow.table(columns), path)


def _split(argument: str) -> tuple[str, Path]:
    group, equals, folder = argument.partition("=")
    if equals and not Path(argument).exists():
        return group, Path(folder)
    return "", Path(argument)


def _labels(folders: Sequence[Path]) -> list[str]:
    """As many last parts of each path as tell them all apart."""
    parts = [folder.resolve().parts for folder in folders]
    for depth in range(1, max((len(part) for part in parts), default=0) + 1):
        labels = ["/".join(part[-depth:]).lstrip("/") for part in parts]
        if len(set(labels)) == len(labels):
            return labels
    return [str(folder) for folder in folders]
