import numpy as np

from gaitlab.report.share_figure import share_figure

PERCENT = np.linspace(0.0, 100.0, 5)


def test_shares_fill_the_whole_height_and_stand_gaps():
    share = np.array([[1.0, 1.0], [np.nan, 2.0], [0.0, 0.0], [1.0, 3.0], [1.0, 1.0]])
    drawn = share_figure(PERCENT, share, ("a", "b"))
    assert drawn.count("<polygon") == 2 and "nan" not in drawn


def test_wide_bands_carry_the_number_of_their_criterion():
    share = np.tile([0.6, 0.38, 0.02], (5, 1))
    drawn = share_figure(PERCENT, share, ("a", "b", "c"))
    assert [f">{number}</text>" in drawn for number in (1, 2, 3)] == [True, True, False]
    assert all(f">{number}  {name}</text>" in drawn for number, name in enumerate("abc", 1))


def test_events_stand_at_their_percentage():
    drawn = share_figure(PERCENT, np.ones((5, 1)), ("a",), {"left foot off": 50.0})
    assert "left foot off" in drawn and 'x1="520"' in drawn


def test_neighbouring_events_stand_in_different_rows():
    drawn = share_figure(PERCENT, np.ones((5, 1)), ("a",), {"right foot strike": 50.0, "left foot off": 58.0})
    heights = [
        drawn.split(f">{name}<")[0].rsplit('y="', 1)[1].split('"')[0] for name in ("right foot strike", "left foot off")
    ]
    assert heights[0] != heights[1]
