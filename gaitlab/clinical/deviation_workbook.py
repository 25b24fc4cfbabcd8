"""Imports the feature workbook of the gait deviation index.

Understood are, on any sheet: 15 columns of 459 numbers one below the other, or 15 rows of 459 (the features); and
either the controls' gait vectors in the same form (more than 15 of them), or a row or column of 15 numbers under a
heading with the words `control` and `mean`, and two numbers beside or below headings with `ln` and
`mean`, `ln` and `sd`.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..errors import InvalidReference
from .gait_deviation_index import N_ELEMENTS, N_FEATURES, DeviationBasis, check_basis
from .workbook import Cell, Sheet, read_sheets


def import_basis(path: Path, source: str) -> DeviationBasis:
    """Read the published basis.

    Raises:
        InvalidReference: The file is no workbook, or the numbers are not found in it.
    """
    sheets = read_sheets(path)
    blocks = [block for sheet in sheets for block in _vectors(sheet)]
    features = next((block for block in blocks if len(block) == N_FEATURES), None)
    if features is None:
        raise InvalidReference(f"{path.name}: no {N_FEATURES} features of {N_ELEMENTS} numbers found on any sheet")
    controls = next((block for block in blocks if len(block) > N_FEATURES), None)
    if controls is not None:
        mean, log_mean, log_sd = _from_controls(features, controls)
    else:
        mean, log_mean, log_sd = _printed(sheets, path.name)
    basis = DeviationBasis(
        name=path.stem,
        source=source,
        features=features.tolist(),
        control_mean=[float(value) for value in mean],
        log_distance_mean=log_mean,
        log_distance_sd=log_sd,
    )
    check_basis(basis)
    return basis


def _from_controls(features: np.ndarray, controls: np.ndarray) -> tuple[Sequence[float], float, float]:
    """Mean feature vector of the controls, and mean and sample sd of the logarithm of their distances from it."""
    vectors = controls @ features.T  # (n_controls, 15)
    mean = vectors.mean(axis=0)
    logs = np.log(np.linalg.norm(vectors - mean, axis=1))
    return mean.tolist(), float(logs.mean()), float(logs.std(ddof=1))


def _vectors(sheet: Sheet) -> list[np.ndarray]:
    """Blocks of gait vectors (n, 459), those in columns and those in rows."""
    if not sheet:
        return []
    numbers = np.array([[cell if isinstance(cell, float) else np.nan for cell in row] for row in sheet])
    return [*_column_blocks(numbers), *_column_blocks(numbers.T)]


def _column_blocks(numbers: np.ndarray) -> list[np.ndarray]:
    blocks: list[list[np.ndarray]] = []
    before = -2
    start_before = -1
    for column in range(numbers.shape[1]):
        start = _start_of_vector(numbers[:, column])
        if start is None or _counts(numbers[start : start + N_ELEMENTS, column]):
            continue
        if column != before + 1 or start != start_before:
            blocks.append([])
        blocks[-1].append(numbers[start : start + N_ELEMENTS, column])
        before, start_before = column, start
    return [np.array(block) for block in blocks]


def _start_of_vector(values: np.ndarray) -> int | None:
    """First row of a run of exactly 459 numbers."""
    known = np.concatenate([[False], np.isfinite(values), [False]])
    edges = np.flatnonzero(known[1:] != known[:-1])
    runs = zip(edges[::2], edges[1::2], strict=True)
    return next((int(start) for start, end in runs if end - start == N_ELEMENTS), None)


def _counts(values: np.ndarray) -> bool:
    """Whether a column only numbers the rows."""
    return bool(np.all(np.diff(values) == values[1] - values[0]))


def _printed(sheets: Sequence[Sheet], name: str) -> tuple[Sequence[float], float, float]:
    mean = _after_heading(sheets, (("control", "mean"),), N_FEATURES)
    log_mean = _after_heading(sheets, (("ln", "mean"),), 1)
    log_sd = _after_heading(sheets, (("ln", "sd"), ("ln", "deviation")), 1)
    if mean is None or log_mean is None or log_sd is None:
        raise InvalidReference(
            f"{name}: the features are there, but neither gait vectors of controls nor their mean, and mean and sd of "
            "the ln distance, under headings that say so"
        )
    return mean, log_mean[0], log_sd[0]


def _after_heading(sheets: Sequence[Sheet], words: Sequence[Sequence[str]], count: int) -> list[float] | None:
    """Numbers to the right of or below the first heading that has all words of one of the choices."""
    for sheet in sheets:
        for row, cells in enumerate(sheet):
            for column, cell in enumerate(cells):
                if isinstance(cell, str) and any(all(_has(cell, word) for word in choice) for choice in words):
                    below = [line[column] for line in sheet[row + 1 : row + 1 + count]]
                    found = _numbers(cells[column + 1 : column + 1 + count], count) or _numbers(below, count)
                    if found:
                        return found
    return None


def _has(heading: str, word: str) -> bool:
    return word in heading.lower().replace("(", " ").replace(")", " ").split()


def _numbers(cells: Sequence[Cell], count: int) -> list[float]:
    numbers = [cell for cell in cells if isinstance(cell, float)]
    return numbers if len(numbers) == count else []
