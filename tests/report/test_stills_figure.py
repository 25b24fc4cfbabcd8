import numpy as np
import pytest
from synthetic_output import BONES, document, walk_arrays, write_output

from gaitlab.mocap.cycles import cycles
from gaitlab.report.result import read_result
from gaitlab.report.stills_figure import OPTIMAL, stills_figure, stride_moments
from gaitlab.report.stills_section import explained_cycle, stills_section
from gaitlab.report.walk_file import Walk


@pytest.fixture
def result(tmp_path):
    return read_result(write_output(tmp_path, document()))


def walk(**changes):
    arrays = walk_arrays() | changes
    return Walk(time=arrays.pop("time"), arrays={k: v for k, v in arrays.items() if v is not None})


def test_moments_divide_the_stride(result):
    moments = stride_moments(cycles(result.events, "left")[0])
    assert [(m.name, round(m.time, 3)) for m in moments] == [
        ("left foot strike", 0.05),
        ("right foot strike", 0.6),
        ("left foot off", 0.72),
        ("left mid-swing", 0.935),
    ]
    assert moments[1].percent == pytest.approx(50.0)


def test_both_skeletons_are_drawn_in_three_views(result):
    moments = stride_moments(cycles(result.events, "left")[0])
    drawn = stills_figure(walk(), moments)
    assert drawn.count(f'stroke="{OPTIMAL}"') == 3 * len(moments) * len(BONES) + 1
    assert all(f">{view}<" in drawn for view in ("from the right", "from ahead", "oblique"))
    assert drawn.count(">L<") == drawn.count(">R<") == 3 * len(moments)


def test_the_person_walks_to_the_right(result):
    # The foot that strikes lies ahead of the pelvis: to the right of it on the figure.
    moments = stride_moments(cycles(result.events, "left")[0])[:1]
    arrays = walk_arrays()
    strides = arrays["segment_positions_measured"].copy()
    strides[:, 8] = strides[:, 0] + (0.0, -0.5, -0.8)
    drawn = stills_figure(walk(segment_positions_measured=strides, segment_positions_optimal=None), moments)
    pelvis, toe = (float(drawn.split("<line")[k].split('x1="')[1].split('"')[0]) for k in (5, 5))
    left_toe = float(drawn.split(">L<")[0].rsplit('x="', 1)[1].split('"')[0])
    assert pelvis == toe and left_toe > pelvis + 50.0


def test_without_an_optimum_the_measured_walk_is_shown_and_the_gap_told(result):
    section = stills_section(result, walk(segment_positions_optimal=None), "")
    words = [block.words for block in section.blocks if hasattr(block, "words")]
    assert any("Not shown: the model-optimal skeleton" in sentence for sentence in words)


@pytest.mark.parametrize("change", [{"bones": None}, {"segment_positions_measured": None}])
def test_without_a_skeleton_the_reason_stands_there(result, change):
    section = stills_section(result, walk(**change), "")
    assert "walk.npz holds no skeleton" in section.blocks[0].words


def test_frames_outside_the_stride_leave_the_optimum_away(result):
    optimal = np.full((241, 9, 3), np.nan)
    moments = stride_moments(cycles(result.events, "left")[0])
    assert "nan" not in stills_figure(walk(segment_positions_optimal=optimal), moments)


def test_a_stride_that_can_be_drawn_is_preferred(result):
    measured = walk_arrays()["segment_positions_measured"]
    measured[:58] = np.nan  # the left foot's first stride starts at 0.05 s, the right foot's at 0.6 s
    assert explained_cycle(result, walk(segment_positions_measured=measured)).start == 1.15


def test_without_any_a_stride_inside_the_recording_is_taken(result):
    nowhere = np.full((241, 9, 3), np.nan)
    assert explained_cycle(result, walk(segment_positions_measured=nowhere)).start == 0.05
