"""Export to CSV and JSON: the curves, the numbers and the events of a result as tables, and the document itself."""

import csv
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from ..clinical.comparison import quantities
from ..clinical.document import CURVES, SIDES, Document, read_document, write_document
from ..errors import OutputError
from .formatting import unit_of

Row = Sequence[object]
_CURVE_HEADER = ("part", "curve", "side", "unit", "statistic", "n_cycles", *(f"p{k}" for k in range(101)))
_VALUE_HEADER = ("part", "quantity", "side", "statistic", "value", "unit")
_EVENT_HEADER = ("trial", "side", "kind", "time_s", "source")


def export_json(directory: Path, target: Path) -> None:
    """Writes the document of a result, checked against the contract.

    Raises:
        InvalidRecording: result.json is absent or does not keep to the contract.
        OutputError: The file cannot be written.
    """
    write_document(read_document(directory / "result.json"), target)


def export_csv(directory: Path, stem: Path) -> tuple[Path, ...]:
    """Writes STEM_curves.csv, STEM_values.csv and STEM_events.csv; a cell is empty where nothing is known.

    Raises:
        InvalidRecording: result.json is absent or does not keep to the contract.
        OutputError: A file cannot be written.
    """
    document = read_document(directory / "result.json")
    tables = {
        "curves": (_CURVE_HEADER, _curves(document)),
        "values": (_VALUE_HEADER, _values(document)),
        "events": (_EVENT_HEADER, ((e.trial, e.side, e.kind, e.time_s, e.source) for e in document.events)),
    }
    return tuple(_write(stem.with_name(f"{stem.name}_{name}.csv"), *table) for name, table in tables.items())


def _write(path: Path, header: Row, rows: Iterable[Row]) -> Path:
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(header)
            writer.writerows(rows)
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose another folder") from error
    return path


def _curves(document: Document) -> Iterator[Row]:
    """Mean and standard deviation of every curve: angles [deg], kinetics and EMG in their units."""
    kinetics = {} if document.kinetics is None else document.kinetics.curves
    envelopes = {} if document.emg is None else document.emg.envelopes
    angles = [("kinematics", name, "deg", document.kinematics[name]) for name in CURVES if name in document.kinematics]
    forces = [("kinetics", name, sides.unit, sides) for name, sides in kinetics.items()]
    muscles = [("emg", name, sides.unit, sides) for name, sides in envelopes.items()]
    for part, name, unit, sides in (*angles, *forces, *muscles):
        for side, curve in (("left", sides.left), ("right", sides.right)):
            if curve is not None:
                head = (part, name, side, unit)
                yield (*head, "mean", curve.n_cycles, *curve.mean)
                yield (*head, "sd", curve.n_cycles, *curve.sd)


def _values(document: Document) -> Iterator[Row]:
    """Distances, times, scores and weights: mean, standard deviation and, of distances and times, each cycle."""
    for q in quantities(document):
        part = "scores" if q.name.startswith(("gvs_", "gps", "gdi")) else "spatiotemporal"
        unit = unit_of(q.name) or ("" if q.name == "gdi" else "deg")
        yield (part, q.name, q.side, "mean", q.value, unit)
        if q.sd is not None:
            yield (part, q.name, q.side, "sd", q.sd, unit)
    for side in SIDES:
        entry = document.spatiotemporal.left if side == "left" else document.spatiotemporal.right
        for number, cycle in enumerate(entry.cycles if entry is not None else (), 1):
            for name in cycle.__struct_fields__:
                yield ("spatiotemporal", name, side, f"cycle {number}", getattr(cycle, name), unit_of(name))
    yield from _dimensionless(document)
    for criterion in document.weights.criteria if document.weights is not None else ():
        yield ("weights", criterion.name, "", "mean", criterion.weight, "1")
        yield ("weights", criterion.name, "", "sd", criterion.sd, "1")


def _dimensionless(document: Document) -> Iterator[Row]:
    """Distances and times divided by those of leg length and gravity (Hof 1996)."""
    for side, entry in (("left", document.spatiotemporal.left), ("right", document.spatiotemporal.right)):
        values = None if entry is None else entry.normalised
        for name in values.__struct_fields__ if values is not None else ():
            yield ("dimensionless", name, side, "mean", getattr(values, name), "1")
