"""Compiled functions, and what happens without a compiler."""

import shutil

import casadi as ca
import numpy as np
import pytest

from gaitlab.errors import ProblemError
from gaitlab.nlp.codegen import Batch, cache_directory, compile_derived, compile_functions

needs_compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="needs a C compiler called cc")


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("GAITLAB_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("GAITLAB_COMPILER", raising=False)
    return tmp_path / "cache"


@pytest.fixture
def functions():
    x, p = ca.SX.sym("x", 3), ca.SX.sym("p", 2)
    value = ca.vertcat(ca.sin(x[0]) * p[0], ca.exp(x[1]) + x[2] ** 3 * p[1])
    return [ca.Function("value", [x, p], [value]), ca.Function("slope", [x, p], [ca.densify(ca.jacobian(value, x))])]


def fake_compiler(tmp_path, script):
    path = tmp_path / "compiler"
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
    return str(path)


def is_compiled(functions):
    return all(f.class_name() == "External" for f in functions.values())


@needs_compiler
def test_compiled_code_equals_the_virtual_machine(functions):
    compiled = compile_functions(functions, "test")
    assert is_compiled(compiled)
    x, p = np.random.default_rng(0).normal(size=(5, 3)), np.array([2.0, -1.0])
    for function in functions:
        np.testing.assert_array_equal(
            Batch(compiled[function.name()], 5)(x, p)[0], Batch(function, 5)(x, p)[0], strict=True
        )


@needs_compiler
def test_the_second_time_nothing_is_compiled(functions, cache, tmp_path, monkeypatch):
    compile_functions(functions, "test")
    libraries = list(cache.iterdir())
    assert [library.suffix for library in libraries] == [".so"]
    monkeypatch.setenv("GAITLAB_COMPILER", fake_compiler(tmp_path, f"touch {tmp_path / 'called'}; exit 1"))
    assert is_compiled(compile_functions(functions, "test"))
    assert not (tmp_path / "called").exists()


@needs_compiler
def test_known_expressions_are_not_derived_again(functions, cache):
    builds = []

    def build():
        builds.append(1)
        return functions

    compile_derived(functions[0], build, "test")
    again = compile_derived(functions[0], build, "test")
    assert is_compiled(again)
    assert len(builds) == 1
    np.testing.assert_allclose(np.array(again["value"]([0, 0, 1], [1, 2])).ravel(), [0, 3])
    compile_derived(functions[1], build, "test")
    next(cache.glob("*.so")).unlink()
    compile_derived(functions[0], build, "test")
    assert len(builds) == 3


@needs_compiler
def test_other_expressions_get_another_library(functions, cache):
    compile_functions(functions, "test")
    compile_functions(functions[:1], "test")
    assert len(list(cache.iterdir())) == 2


@pytest.mark.parametrize("compiler", ["", "no-such-compiler"])
def test_without_a_compiler_the_virtual_machine_serves(functions, compiler, monkeypatch, cache):
    monkeypatch.setenv("GAITLAB_COMPILER", compiler)
    assert compile_functions(functions, "test") == {f.name(): f for f in functions}
    assert not cache.exists()


@pytest.mark.parametrize("script", ["exit 1", "exit 0"])
def test_a_broken_compiler_falls_back(functions, script, monkeypatch, tmp_path, cache):
    monkeypatch.setenv("GAITLAB_COMPILER", fake_compiler(tmp_path, script))
    assert not is_compiled(compile_functions(functions, "test"))
    assert not list(cache.iterdir())


def test_a_cache_that_cannot_be_written_falls_back(functions, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("GAITLAB_CACHE", str(tmp_path / "file" / "below"))
    assert not is_compiled(compile_functions(functions, "test"))


@needs_compiler
@pytest.mark.parametrize("compiler", ["cc", "false"])
def test_a_damaged_library_is_built_again_or_not_used(functions, cache, compiler, monkeypatch):
    compile_functions(functions, "test")
    (library,) = cache.iterdir()
    library.unlink()  # Another file of the same name: the first one may still be mapped.
    library.write_bytes(b"damaged")
    monkeypatch.setenv("GAITLAB_COMPILER", compiler)
    compiled = compile_functions(functions, "test")
    assert is_compiled(compiled) == (compiler == "cc")
    np.testing.assert_allclose(np.array(compiled["value"]([0, 0, 1], [1, 2])).ravel(), [0, 3])


def test_cache_directory_follows_the_environment(monkeypatch, tmp_path):
    assert cache_directory() == tmp_path / "cache"
    monkeypatch.delenv("GAITLAB_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_directory() == tmp_path / "gaitlab"


def test_batches_broadcast_and_return_columns(functions):
    """Matrices come back transposed: CasADi stores columns."""
    value, slope = functions
    x, p = np.arange(6.0).reshape(2, 3), np.array([[1.0, 2.0], [3.0, 4.0]])
    expected = [np.array(slope(x[i], p[i])).T for i in range(2)]
    np.testing.assert_array_equal(Batch(slope, 2)(x, p)[0], expected)
    shared = Batch(value, 2)(x, p[0])[0]
    np.testing.assert_array_equal(shared, [np.array(value(x[i], p[0])).ravel() for i in range(2)])


def test_batches_refuse_sparse_results():
    x = ca.SX.sym("x", 2)
    with pytest.raises(ProblemError, match="dense"):
        Batch(ca.Function("f", [x], [ca.jacobian(x**2, x)]), 3)
