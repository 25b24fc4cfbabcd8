import re

from gaitlab.clinical.gait_profile import VARIABLES
from gaitlab.report.profile_figure import HIGHEST, profile_figure


def test_a_score_beyond_the_scale_does_not_cover_its_neighbour():
    scores = {side: dict.fromkeys(VARIABLES, value) for side, value in (("left", HIGHEST + 1.5), ("right", HIGHEST))}
    markup = profile_figure(scores, {"left": None, "right": None, "overall": None}, {})
    heights = {words: float(y) for y, words in re.findall(r'y="([0-9.]+)"[^>]*>([0-9.]+↑?)</text>', markup)}
    assert heights["30.0"] - heights["31.5↑"] >= 12.0
