import csv

import numpy as np
import pytest
from report.page import Page, render
from report.test_kinetics_sections import written
from synthetic_output import N_FRAMES, RATE, document, walk_arrays, write_output

from gaitlab.clinical.cycle_average import average, time_normalise_forces
from gaitlab.report.consistency_sections import every_cycle
from gaitlab.report.source import read_source

TIME = np.arange(N_FRAMES) / RATE
TITLE = "All cycles: kinetics</h2>"


def write_kinetics(directory, known=TIME >= 0.0):
    """A table of hip powers; the synthetic walk has two cycles of the left foot, 0.05 to 1.15 to 2.25 s."""
    columns = {"time": TIME, "left_hip_power": np.where(known, np.sin(TIME), np.nan)}
    with (directory / "kinetics.csv").open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(columns)
        for row in zip(*columns.values(), strict=True):
            writer.writerow("" if np.isnan(value) else f"{value:.6f}" for value in row)


@pytest.fixture
def walked(tmp_path):
    return write_output(tmp_path, written(), walk_arrays())


def shown(directory):
    return render(directory, "consistency").split(TITLE)[1]


def test_every_stride_is_a_thin_line_below_the_mean(walked):
    write_kinetics(walked)
    panel = shown(walked).split('data-curve="hip_power"')[1].split("</g>")[0]
    assert panel.count('stroke-width="0.8"') == 2 and panel.count('stroke-width="2.4"') >= 1
    assert panel.rindex('stroke-width="0.8"') < panel.rindex("<path", 0, panel.rindex('stroke-width="2.4"'))


def test_angles_are_drawn_in_the_same_way(walked):
    panel = render(walked, "consistency").split('data-curve="knee_flexion"')[1].split("</g>")[0]
    assert panel.count('stroke-width="0.8"') == 3 and panel.count("<path") == 5


def test_the_strides_average_to_what_they_were_made_of(walked):
    write_kinetics(walked)
    trial = read_source(walked).trials[0]
    drawn = every_cycle(trial.result, trial.kinetics, ["hip_power"], time_normalise_forces)["hip_power"]["left"]
    starts = np.array([0.05, 1.15])[:, None] + np.linspace(0.0, 1.1, 101)
    assert np.max(np.abs(average(drawn)[0] - np.sin(starts).mean(axis=0))) < 2e-5


def test_a_stride_without_its_whole_ground_reaction_is_left_out(walked):
    write_kinetics(walked, known=TIME < 2.0)
    assert "Reason: no side has two complete cycles with a valid plate contact" in Page(shown(walked)).text


@pytest.mark.parametrize(("content", "why"), [(None, "no trial has kinetics"), ("time\nx\n", "not a table of numbers")])
def test_without_a_table_the_reason_stands_there(tmp_path, content, why):
    directory = write_output(tmp_path, document(), walk_arrays())
    if content is not None:
        (directory / "kinetics.csv").write_text(content)
    text = Page(shown(directory)).text
    assert "Not shown: moments, powers and ground reactions of every cycle. Reason:" in text and why in text
