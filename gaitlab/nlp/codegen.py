"""Evaluating one CasADi function at many points at once, compiled when there is a compiler.

Expressions hold no numbers of a subject or a trial, so the compiled code is cached by the hash of its source and
serves every patient. Without a C compiler CasADi's virtual machine evaluates the same expressions.
"""

import contextlib
import hashlib
import inspect
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import casadi as ca
import msgspec
import numpy as np

from ..errors import ProblemError


def cache_directory() -> Path:
    """Folder of compiled functions: $GAITLAB_CACHE, else $XDG_CACHE_HOME/gaitlab, else ~/.cache/gaitlab."""
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(os.environ.get("GAITLAB_CACHE") or Path(base) / "gaitlab")


def compile_functions(functions: Sequence[ca.Function], name: str) -> dict[str, ca.Function]:
    """Compile the functions into one shared library, or return them as they are where that is impossible.

    The result maps function names to functions. `GAITLAB_COMPILER` names the compiler; empty means: do not compile.
    """
    return _compile(functions, name)[0]


def compile_derived(
    expressions: ca.Function, build: Callable[[], Sequence[ca.Function]], name: str
) -> dict[str, ca.Function]:
    """Compile `build()`, functions that depend on nothing but `expressions` and the module that defines `build`.

    Deriving and printing long expressions takes seconds; they are skipped where the library of the same expressions
    is in the cache already. Otherwise as `compile_functions`.
    """
    text = expressions.serialize() + inspect.getsource(inspect.getmodule(build) or build)
    note = cache_directory() / f"{name}_{_key(text)}.json"
    if _compiler() is not None:
        known = _read_note(note)
        loaded = _load(known.names, note.with_name(known.library)) if known is not None else None
        if loaded is not None:
            return loaded
    functions, library = _compile(build(), name)
    if library is not None:
        _write_note(note, _Note(names=list(functions), library=library.name))
    return functions


class _Note(msgspec.Struct):
    """Which library holds the functions derived from some expressions."""

    names: list[str]
    library: str


def _read_note(path: Path) -> _Note | None:
    try:
        return msgspec.json.decode(path.read_bytes(), type=_Note)
    except (OSError, msgspec.DecodeError):
        return None


def _write_note(path: Path, note: _Note) -> None:
    with contextlib.suppress(OSError), tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        file.write(msgspec.json.encode(note))
        file.close()
        Path(file.name).replace(path)


def _compile(functions: Sequence[ca.Function], name: str) -> tuple[dict[str, ca.Function], Path | None]:
    """The functions, and the library that they were loaded from if they are compiled."""
    interpreted = {f.name(): f for f in functions}
    compiler = _compiler()
    if compiler is None:
        return interpreted, None
    source = _source(functions, name)
    library = cache_directory() / f"{name}_{_key(source)}.so"
    loaded = _load(list(interpreted), library)
    if loaded is None and _build(compiler, source, library):
        loaded = _load(list(interpreted), library)
    return (interpreted, None) if loaded is None else (loaded, library)


def _compiler() -> str | None:
    compiler = os.environ.get("GAITLAB_COMPILER", "cc")
    return compiler if compiler and shutil.which(compiler) is not None else None


def _key(text: str) -> str:
    return hashlib.sha256(text.encode() + ca.CasadiMeta.version().encode()).hexdigest()[:20]


def _load(names: Sequence[str], library: Path) -> dict[str, ca.Function] | None:
    """Functions of the library; None where it does not exist or cannot be loaded, for instance a damaged file."""
    if not library.exists():
        return None
    try:
        return {name: ca.external(name, str(library)) for name in names}
    except RuntimeError:
        return None


def _source(functions: Sequence[ca.Function], name: str) -> str:
    generator = ca.CodeGenerator(f"{name}.c")
    for function in functions:
        generator.add(function)
    return str(generator.dump())


def _build(compiler: str, source: str, library: Path) -> bool:
    """Compile into a temporary file and rename it, so that two processes may build at once."""
    try:
        library.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=library.parent) as folder:
            (Path(folder) / "code.c").write_text(source)
            # -O1 compiles these long straight-line functions in a fifth of the time of -O2 and runs as fast.
            command = [compiler, "-O1", "-fPIC", "-shared", "-w", "code.c", "-o", "code.so", "-lm"]
            subprocess.run(command, cwd=folder, check=True, capture_output=True, timeout=600)
            (Path(folder) / "code.so").replace(library)
    except (OSError, subprocess.SubprocessError):
        return False
    return True


@dataclass(frozen=True)
class Batch:
    """A CasADi function mapped over n points, called with and returning numpy arrays without copies."""

    function: ca.Function
    n: int
    _mapped: ca.Function = field(init=False, repr=False)
    _sizes: tuple[int, ...] = field(init=False, repr=False)
    """Of the arguments: asking CasADi costs as much as a small function."""
    _shapes: tuple[tuple[int, ...], ...] = field(init=False, repr=False)
    """Of the results."""

    def __post_init__(self) -> None:
        f = self.function
        sparse = [name for name in f.name_in() if not f.sparsity_in(name).is_dense()]
        sparse += [name for name in f.name_out() if not f.sparsity_out(name).is_dense()]
        if sparse:
            raise ProblemError(f"{f.name()} must have dense arguments and results (ca.densify), {sparse} are sparse")
        shapes = [f.size_out(i) for i in range(f.n_out())]
        object.__setattr__(self, "_mapped", self.function.map(self.n))
        object.__setattr__(self, "_sizes", tuple(f.numel_in(i) for i in range(f.n_in())))
        object.__setattr__(
            self, "_shapes", tuple((self.n, rows) if cols == 1 else (self.n, cols, rows) for rows, cols in shapes)
        )

    def __call__(self, *arguments: np.ndarray) -> list[np.ndarray]:
        """Evaluate at points given as arrays of shape (n, size); vectors of shape (size,) are shared by all points.

        Dense matrices come back column-major per point: shape (n, columns, rows); vectors as (n, size).
        """
        inputs = [self._input(a, size) for a, size in zip(arguments, self._sizes, strict=True)]
        results = [np.empty(shape) for shape in self._shapes]
        buffer, trigger = self._mapped.buffer()
        for i, value in enumerate(inputs):
            buffer.set_arg(i, value.data)  # pyright: ignore[reportCallIssue] (SWIG takes the size from the view)
        for i, result in enumerate(results):
            buffer.set_res(i, result.data)  # pyright: ignore[reportCallIssue]
        trigger()
        return results

    def _input(self, values: np.ndarray, size: int) -> np.ndarray:
        if values.shape != (self.n, size):
            values = np.broadcast_to(values, (self.n, size))
        return np.ascontiguousarray(values, dtype=np.float64)
