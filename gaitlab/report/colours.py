"""Colours of the report: side by colour, session by line style (design/clinical.md)."""

SIDE = {"left": "#c8281e", "right": "#1d5fae"}
CENTRE = "#3d4752"
"""Segments that belong to no side, and totals."""
CRITERIA = ("#1b7f79", "#d08a1c", "#7a5195", "#7d8f2b", "#8c564b", "#5a7d9a", "#b5739d", "#8a8a8a")


def criterion_colour(index: int) -> str:
    """Colour of a criterion; they repeat after eight."""
    return CRITERIA[index % len(CRITERIA)]


def side_of(name: str) -> str | None:
    """Side that a segment, joint or contact belongs to by its name; None for the middle."""
    return next((side for side in SIDE if name.startswith((f"{side}_", f"{side} "))), None)
