"""Line styles and colours that tell sides apart for every eye and on grey paper."""

import numpy as np
import pytest

from gaitlab.report.colours import CENTRE, CRITERIA, DASH, PALETTES, SIDE, recoloured
from gaitlab.report.cycle_panels import TICK_DASH
from gaitlab.report.walk_figure import Trace

PAPER, BAND = "#ffffff", "#d3d8dd"
# Viénot, Brettel & Mollon 1999: linear RGB as seen without long- or without middle-wavelength cones.
BLINDNESS = {
    "protanopia": [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]],
    "deuteranopia": [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]],
}


def linear(colour):
    part = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)


def luminance(rgb):
    return float(rgb @ (0.2126, 0.7152, 0.0722))


def contrast(a, b):
    """Contrast ratio of WCAG 2 from linear RGB."""
    light, dark = sorted((luminance(a), luminance(b)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def sides(palette):
    return {side: recoloured(colour, palette) for side, colour in SIDE.items()}


def test_sides_differ_in_line_style_so_that_no_colour_is_needed():
    assert DASH["left"] != DASH["right"] and TICK_DASH["left"] != TICK_DASH["right"]
    styles = {
        Trace(values=np.zeros(0), side=side, modelled=model).style["stroke_dasharray"]
        for side in SIDE
        for model in (False, True)
    }
    assert len(styles) == 4


@pytest.mark.parametrize("palette", PALETTES)
def test_every_line_stands_out_from_paper_and_from_the_grey_band(palette):
    for colour in (*sides(palette).values(), CENTRE):
        assert contrast(linear(colour), linear(PAPER)) >= 4.5
        assert contrast(linear(colour), linear(BAND)) >= 3.0


def test_safe_sides_differ_in_grey():
    left, right = (linear(colour) for colour in sides("safe").values())
    assert contrast(left, right) >= 3.0


@pytest.mark.parametrize("kind", BLINDNESS)
def test_safe_sides_differ_for_the_colour_blind(kind):
    left, right = (np.clip(BLINDNESS[kind] @ linear(colour), 0.0, 1.0) for colour in sides("safe").values())
    assert contrast(left, right) >= 2.0 and np.linalg.norm(left - right) > 0.15


def test_a_palette_changes_nothing_but_its_colours():
    markup = f'<path stroke="{SIDE["left"]}"/><path stroke="{CRITERIA[0]}"/>'
    assert recoloured(markup, "standard") == markup
    assert recoloured(markup, "green") == markup
    assert recoloured(markup, "safe") == markup.replace(SIDE["left"], "#c45500")
