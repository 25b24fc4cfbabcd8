import json

import casadi as ca
import pytest


@pytest.fixture
def folder(tmp_path):
    """Minimise (x - 1)^2 + (y - 2)^2 on the two half axes: the best is (0, 2)."""
    w = ca.SX.sym("w", 2)
    f = (w[0] - 1) ** 2 + (w[1] - 2) ** 2
    parts = {"f": f, "g": ca.SX(0, 1), "G": w[0], "H": w[1]}
    functions = {f"{name}_fun": ca.Function(name, [w], [part]).serialize() for name, part in parts.items()}
    bounds = {"lbw": [0.0, 0.0], "ubw": [9.0, 9.0], "lbg": [], "ubg": []}
    document = {"name": "corner", "w0": [0.1, 1.0], "sense": "minimize"} | bounds | functions
    (tmp_path / "corner.json").write_text(json.dumps(document))
    (tmp_path / "reference.csv").write_text("problem,best_known\ncorner,1.0\n")
    return tmp_path


def test_a_folder_is_solved_and_written(gaitlab, folder, tmp_path):
    out = tmp_path / "results.csv"
    code, text, _ = gaitlab("benchmark", "mpcc", folder, "--method", "penalty-ipopt", "--starts", 2, "--out", out)
    assert code == 0
    assert "1 of 1" in text
    assert out.read_text().splitlines()[1].startswith("corner,penalty-ipopt,solved,1")
    assert "<svg" in (tmp_path / "results.svg").read_text()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [(["--method", "guess"], "'guess' does not exist"), (["--out", "/nowhere/results.csv"], "/nowhere/results.csv")],
)
def test_bad_arguments_are_refused_in_one_line(gaitlab, folder, arguments, sentence):
    given = [] if "--out" in arguments else ["--out", folder / "out.csv"]
    fast = [] if "--method" in arguments else ["--method", "penalty-ipopt"]
    code, _, err = gaitlab("benchmark", "mpcc", folder, *arguments, *given, *fast)
    assert code == 2
    assert sentence in err and len(err.strip().splitlines()) == 1
