from synthetic_output import document, write_output

from gaitlab.report.result import read_result
from gaitlab.report.weights_figure import fit_figure, weights_figure


def test_only_what_is_not_identifiable_is_hatched(tmp_path):
    drawn = weights_figure(read_result(write_output(tmp_path, document())).weights)
    assert drawn.count('class="hatched"') == 1
    assert "0.55 ± 0.04" in drawn and "0.05 not identifiable" in " ".join(drawn.split())


def test_the_best_fit_stands_first():
    drawn = fit_figure(0.04, {"equal weights": 0.03, "only torque": 0.05})
    assert drawn.index(">equal weights<") < drawn.index(">weights found<") < drawn.index(">only torque<")
