"""JSON values as words and numbers for people."""

from .result import mapping, real, sequence

ABSENT = "–"
_UNITS = {
    "_m_per_s": "m/s",
    "_m_s": "m/s",
    "_per_min": "1/min",
    "_steps_per_min": "steps/min",
    "_percent": "%",
    "_pct": "%",
    "_seconds": "s",
    "_deg": "deg",
    "_rad": "rad",
    "_mm": "mm",
    "_hz": "Hz",
    "_kg": "kg",
    "_nm_per_kg": "N·m/kg",
    "_m": "m",
    "_s": "s",
    "_n": "N",
}


def unit_of(key: str) -> str:
    """Unit that a key's ending names: `step_length_m` is in m; empty if it names none."""
    endings = sorted(_UNITS, key=len, reverse=True)
    return next((_UNITS[ending] for ending in endings if key.lower().endswith(ending)), "")


def label(key: str) -> str:
    """Name of a key for people: `step_length_m` reads `Step length [m]`."""
    unit = unit_of(key)
    ending = next((e for e in sorted(_UNITS, key=len, reverse=True) if key.lower().endswith(e)), "") if unit else ""
    words = key[: len(key) - len(ending)].replace("_", " ").removeprefix("n ").strip() or key
    return f"{words[:1].upper()}{words[1:]}" + (f" [{unit}]" if unit else "")


def plain(value: object, digits: int = 4) -> str:
    """A JSON scalar for people: four significant digits, yes and no, a dash for nothing."""
    if value is None:
        return ABSENT
    if isinstance(value, bool):
        return "yes" if value else "no"
    number = real(value)
    if isinstance(value, int) or number is None:
        return str(value)
    return f"{number:.{digits}g}"


def fixed(value: float | None, decimals: int) -> str:
    """A number with fixed decimals, a dash for nothing."""
    return ABSENT if value is None else f"{value:.{decimals}f}"


def rows_of(value: object, prefix: str = "") -> list[tuple[str, str]]:
    """Flatten any JSON value to rows of name and value; nested names are joined with ` / `."""
    if members := mapping(value):
        parts = [
            rows_of(member, f"{prefix} / {label(key)}" if prefix else label(key)) for key, member in members.items()
        ]
        return [row for part in parts for row in part]
    if items := sequence(value):
        if any(isinstance(item, dict | list) for item in items):
            parts = [rows_of(item, f"{prefix} {number}") for number, item in enumerate(items, 1)]
            return [row for part in parts for row in part]
        return [(prefix, ", ".join(plain(item) for item in items))]
    empty = isinstance(value, dict | list)
    return [(prefix, "none" if empty else plain(value))]
