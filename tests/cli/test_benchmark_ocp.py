from gaitlab.pipelines.inverse_methods import METHODS

FAST = next(iter(METHODS))


def test_one_problem_by_one_method_is_printed_and_written(gaitlab, tmp_path):
    code, out, _ = gaitlab("benchmark", "ocp", "--problem", "reeds-shepp", "--method", FAST, "--out", tmp_path)
    assert code == 0
    assert "Optimal control" in out and "Inverse problems" in out
    assert {path.name for path in tmp_path.iterdir()} == {
        "optimal_control.csv", "inverse.csv", "reeds-shepp.svg", "reeds-shepp-path.svg",
    }  # fmt: skip
    assert "certified, confirmed" in (tmp_path / "optimal_control.csv").read_text()


def test_unknown_problems_and_methods_are_refused_in_one_line(gaitlab, tmp_path):
    for option, value in (("--problem", "moon"), ("--method", "guess")):
        code, _, err = gaitlab("benchmark", "ocp", "--problem", "reeds-shepp", option, value, "--out", tmp_path)
        assert code == 2
        assert f"'{value}' does not exist" in err and len(err.strip().splitlines()) == 1


def test_a_folder_that_cannot_be_made_is_named(gaitlab, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    code, _, err = gaitlab("benchmark", "ocp", "--problem", "reeds-shepp", "--method", FAST, "--out", blocked / "sub")
    assert code == 2
    assert str(blocked) in err
