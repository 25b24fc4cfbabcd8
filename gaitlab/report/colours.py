"""Colours of the report: side by colour and, for grey paper, by line style; palettes for other eyes."""

from collections.abc import Mapping
from typing import Literal

SIDE = {"left": "#c8281e", "right": "#1d5fae"}
DASH = {"left": "none", "right": "7 2.5"}
"""Line style of each side, so that curves can be told apart in grey."""
CENTRE = "#3d4752"
"""Segments that belong to no side, and totals."""
CRITERIA = ("#1b7f79", "#d08a1c", "#7a5195", "#7d8f2b", "#8c564b", "#5a7d9a", "#b5739d", "#8a8a8a")

Palette = Literal["standard", "green", "safe"]
PALETTES: Mapping[Palette, Mapping[str, str]] = {
    "standard": {},
    "green": {SIDE["right"]: "#1e7b34"},
    "safe": {SIDE["left"]: "#c45500", SIDE["right"]: "#002b5c"},
}
"""What each palette puts in the place of the standard colours. `safe`: vermilion and navy, which differ for every kind
of colour blindness and in brightness."""


def criterion_colour(index: int) -> str:
    """Colour of a criterion; they repeat after eight."""
    return CRITERIA[index % len(CRITERIA)]


def side_of(name: str) -> str | None:
    """Side that a segment, joint or contact belongs to by its name; None for the middle."""
    return next((side for side in SIDE if name.startswith((f"{side}_", f"{side} "))), None)


def recoloured(markup: str, palette: Palette) -> str:
    """The same report in the colours of a palette."""
    for standard, other in PALETTES[palette].items():
        markup = markup.replace(standard, other)
    return markup
