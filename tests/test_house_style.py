"""The rules of the house that no linter knows."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
MODULES = sorted((ROOT / "gaitlab").rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("test_*.py"))
SCRIPTS = sorted((ROOT / "benchmarks").rglob("*.py"))
FUNCTIONS = ast.FunctionDef | ast.AsyncFunctionDef
MAX_FILE_LINES = 400
MAX_BODY_LINES = 50
VAGUE_NAMES = {"utils", "helpers", "common", "core", "base", "misc"}
README_LINES = 150
README_CODE_BEFORE = 30


def name(path):
    return str(path.relative_to(ROOT))


def nodes(path, kind):
    return [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, kind)]


def body_length(function):
    docstring = function.body[0] if ast.get_docstring(function) else None
    lines = function.end_lineno - function.lineno + 1
    return lines - (docstring.end_lineno - docstring.lineno + 1 if docstring else 0)


def takes_or_returns_array(function):
    arguments = function.args.posonlyargs + function.args.args + function.args.kwonlyargs
    hints = [argument.annotation for argument in arguments] + [function.returns]
    return any(hint is not None and "ndarray" in ast.unparse(hint) for hint in hints)


def public_array_functions(path):
    """Public functions and methods that take or return arrays, unless they are nested or belong to a private class."""
    tree = ast.parse(path.read_text())
    owners = [tree] + [node for node in tree.body if isinstance(node, ast.ClassDef) and not node.name.startswith("_")]
    functions = [node for owner in owners for node in owner.body if isinstance(node, FUNCTIONS)]
    return [f for f in functions if not f.name.startswith("_") and takes_or_returns_array(f)]


def states_shapes_or_units(docstring):
    return "shape" in docstring or "(n" in docstring or "(3" in docstring or "[" in docstring


@pytest.mark.parametrize("path", MODULES + SCRIPTS + TESTS, ids=name)
def test_files_are_short(path):
    assert len(path.read_text().splitlines()) <= MAX_FILE_LINES


@pytest.mark.parametrize("path", MODULES + SCRIPTS + TESTS, ids=name)
def test_functions_are_short(path):
    long = [f.name for f in nodes(path, FUNCTIONS) if body_length(f) > MAX_BODY_LINES]
    assert not long, f"more than {MAX_BODY_LINES} lines: {long}"


@pytest.mark.parametrize("path", MODULES, ids=name)
def test_array_attributes_state_their_shape(path):
    for owner in nodes(path, ast.ClassDef):
        for field, doc in zip(owner.body, [*owner.body[1:], None], strict=True):
            if isinstance(field, ast.AnnAssign) and "ndarray" in ast.unparse(field.annotation):
                text = ast.unparse(doc) if isinstance(doc, ast.Expr) else ""
                assert re.search(r"shapes? \(", text), f"{owner.name}.{ast.unparse(field.target)} has no 'shape (...)'"


@pytest.mark.parametrize("path", MODULES, ids=name)
def test_public_array_functions_state_shapes_and_units(path):
    for function in public_array_functions(path):
        docstring = ast.get_docstring(function) or ""
        assert states_shapes_or_units(docstring), f"{function.name}: give shapes, e.g. '(n, 3)', and units, e.g. '[m]'"


@pytest.mark.parametrize("path", MODULES, ids=name)
def test_imports_stand_at_the_top(path):
    local = [f.name for f in nodes(path, FUNCTIONS) for n in ast.walk(f) if isinstance(n, ast.Import | ast.ImportFrom)]
    assert not local, f"imports inside functions: {local}"


@pytest.mark.parametrize("path", MODULES, ids=name)
def test_no_exception_is_swallowed_or_nameless(path):
    assert not [handler.lineno for handler in nodes(path, ast.ExceptHandler) if handler.type is None]
    raised = [ast.unparse(n.exc) for n in nodes(path, ast.Raise) if n.exc is not None]
    assert not [text for text in raised if text.startswith(("Exception", "BaseException"))]


@pytest.mark.parametrize("path", MODULES, ids=name)
def test_modules_have_telling_names(path):
    assert path.stem not in VAGUE_NAMES


@pytest.mark.parametrize("path", MODULES, ids=name)
def test_only_the_c3d_reader_imports_ezc3d(path):
    imported = {alias.name for node in nodes(path, ast.Import) for alias in node.names}
    imported |= {node.module for node in nodes(path, ast.ImportFrom)}
    assert "ezc3d" not in imported or name(path).startswith("gaitlab/mocap/c3d")


def test_readme_is_a_short_front_door():
    lines = (ROOT / "README.md").read_text().splitlines()
    first_code = next(number for number, line in enumerate(lines, 1) if line.startswith("```"))
    assert len(lines) <= README_LINES
    assert first_code < README_CODE_BEFORE


def test_constraints_name_versions_only():
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    assert all(line.startswith("#") or ("==" in line and "://" not in line and "@" not in line) for line in lines)
