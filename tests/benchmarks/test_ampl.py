import gzip
import json

import casadi as ca
import numpy as np
import pytest

from gaitlab.benchmarks.ampl import read_ampl
from gaitlab.benchmarks.casadi_json import read_casadi_json
from gaitlab.errors import ProblemError

HEAD = """g3 1 1 0	# problem toy
 3 {n} 1 0 0	# vars, constraints, objectives, ranges, eqns
 0 1 {n} 0 {nd} 0	# nonlinear constrs, objs; ccons: lin, nonlin, nd, nzlb
 0 0	# network constraints: nonlinear, linear
 0 1 0	# nonlinear vars in constraints, objectives, both
 0 0 0 1	# linear network variables; functions; arith, flags
 0 0 0 0 0	# discrete variables: binary, integer, nonlinear (b,c,o)
 {n} 1	# nonzeros in Jacobian, gradients
 0 0	# max name lengths: constraints, variables
 0 0 0 0 0	# common exprs: b,c,o,c1,o1
C0
n-5
O0 {sense}
o5
v0
n2
x1
0 1.5
r
{row}
b
0 -10 20
2 3
1 7
k2
1
1
J0 1
0 2
G0 1
0 0
"""


def written(tmp_path, row, sense=0):
    """Minimise or maximise v0^2; the row's body is 2 v0 - 5; v0 in [-10, 20], v1 >= 3, v2 <= 7."""
    path = tmp_path / "toy.nl"
    path.write_text(HEAD.format(n=1, nd=0, sense=sense, row=row))
    return path


def halves(named, w):
    problem = named.problem
    first, second, g = ca.Function("halves", [problem.w], [problem.G, problem.H, problem.g])(w)
    return first.full().ravel(), second.full().ravel(), g.full().ravel()


@pytest.mark.parametrize(
    ("row", "first", "second"),
    [("5 1 2", [3.0], [8.0]), ("5 2 3", [-3.0], [-6.0])],
    ids=["lower bound", "upper bound"],
)
def test_one_sided_pairs(tmp_path, row, first, second):
    named = read_ampl(written(tmp_path, row))
    G, H, _ = halves(named, [4.0, 11.0, 13.0])
    np.testing.assert_allclose(G, first)  # body 3, negated where it complements an upper bound
    np.testing.assert_allclose(H, second)


def test_a_two_sided_pair_gets_slacks(tmp_path):
    named = read_ampl(written(tmp_path, "5 3 1"))
    assert named.problem.w.numel() == 5
    G, H, g = halves(named, [4.0, 11.0, 5.0, 3.5, 0.5])
    np.testing.assert_allclose(G, [3.5, 0.5])
    np.testing.assert_allclose(H, [14.0, 16.0])
    np.testing.assert_allclose(g, [0.0])  # 3 = 3.5 - 0.5
    np.testing.assert_allclose(named.start, [1.5, 0.0, 0.0, 0.0, 0.0])


def test_a_pair_with_a_free_variable_is_an_equation(tmp_path):
    problem = read_ampl(written(tmp_path, "5 0 1")).problem
    assert problem.n_pairs == 0
    np.testing.assert_allclose([problem.lbg, problem.ubg], 0.0)


@pytest.mark.parametrize(("sense", "sign"), [(0, 1.0), (1, -1.0)], ids=["minimise", "maximise"])
def test_maxima_are_turned_into_minima(tmp_path, sense, sign):
    named = read_ampl(written(tmp_path, "2 0", sense))
    f = ca.Function("f", [named.problem.w], [named.problem.f])([3.0, 0.0, 0.0])
    assert float(f) == pytest.approx(sign * 9.0)
    assert named.sense == sign


@pytest.mark.parametrize(
    ("row", "sentence"), [("5 1 9", "row 0 complements variable"), ("5 1 3", r"a bound that w\[2\] does not have")]
)
def test_damaged_pairs_are_named(tmp_path, row, sentence):
    with pytest.raises(ProblemError, match=sentence):
        read_ampl(written(tmp_path, row))


@pytest.mark.parametrize("content", [b"b3 0 1 0", b"\xff\xfe\x00", b"g3\n"])
def test_files_that_are_no_text_problems_are_refused(tmp_path, content):
    path = tmp_path / "bad.nl"
    path.write_bytes(content)
    with pytest.raises(ProblemError, match=r"bad\.nl"):
        read_ampl(path)


def document():
    w = ca.SX.sym("w", 2)
    parts = {"f": ca.sumsqr(w), "g": ca.SX(0, 1), "G": w[0], "H": w[1]}
    functions = {f"{name}_fun": ca.Function(name, [w], [part]).serialize() for name, part in parts.items()}
    bounds = {"lbw": [-np.inf, 0.0], "ubw": [np.inf, 1.0], "lbg": [], "ubg": []}
    return {"name": "toy", "w0": [1.0, 0.0], "sense": "maximize"} | bounds | functions


@pytest.mark.parametrize("ending", [".json", ".json.gz"])
def test_serialised_functions(tmp_path, ending):
    path, data = tmp_path / f"toy{ending}", json.dumps(document()).encode()
    path.write_bytes(gzip.compress(data) if ending.endswith("gz") else data)
    named = read_casadi_json(path)
    assert (named.name, named.sense, named.problem.n_pairs) == ("toy", -1, 1)


@pytest.mark.parametrize(
    ("change", "sentence"), [({"H_fun": None}, "cannot be read"), ({"H_fun": "aaaa"}, "cannot be read")]
)
def test_damaged_functions_are_refused(tmp_path, change, sentence):
    path = tmp_path / "toy.json"
    path.write_text(json.dumps(document() | change))
    with pytest.raises(ProblemError, match=sentence):
        read_casadi_json(path)


def test_missing_keys_are_named(tmp_path):
    path = tmp_path / "toy.json"
    path.write_text(json.dumps({"w0": []}))
    with pytest.raises(ProblemError, match="lbw, ubw"):
        read_casadi_json(path)
