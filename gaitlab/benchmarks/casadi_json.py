"""Reads MPCCs whose functions are serialised by CasADi, in JSON, plain or compressed.

Keys: name, w0, lbw, ubw, lbg, ubg, f_fun, g_fun, G_fun, H_fun, sense. The functions take w; f is always minimised,
`sense` ("minimize" or "maximize") only says which sign its author gave it. G >= 0, H >= 0, G_i H_i = 0.
"""

import gzip
import json
import zlib
from pathlib import Path

import casadi as ca
import numpy as np

from ..errors import ProblemError
from ..nlp.mpcc import MPCC
from .mpcc_problem import NamedMPCC

KEYS = ("w0", "lbw", "ubw", "lbg", "ubg", "f_fun", "g_fun", "G_fun", "H_fun")


def read_casadi_json(path: Path) -> NamedMPCC:
    """Problem of a `.json` or `.json.gz` file.

    Raises:
        ProblemError: The file is damaged, or a key is missing.
    """
    try:
        data = path.read_bytes()
        document = json.loads(gzip.decompress(data) if path.suffix == ".gz" else data)
    except (OSError, EOFError, ValueError, zlib.error) as error:
        raise ProblemError(f"{path}: not a JSON document ({error})") from error
    missing = [key for key in KEYS if key not in document] if isinstance(document, dict) else list(KEYS)
    if missing:
        raise ProblemError(f"{path}: keys {', '.join(missing)} are missing")
    w = ca.SX.sym("w", len(document["w0"]))
    f, g, first, second = (_expression(path, document[key], w) for key in KEYS[5:])
    lbw, ubw, lbg, ubg = (np.array(document[key], dtype=float) for key in KEYS[1:5])
    return NamedMPCC(
        name=str(document.get("name", path.name.split(".")[0])),
        problem=MPCC(w=w, f=f, g=g, G=first, H=second, lbw=lbw, ubw=ubw, lbg=lbg, ubg=ubg),
        w0=np.array(document["w0"], dtype=float),
        sense=-1 if document.get("sense") == "maximize" else 1,
    )


def _expression(path: Path, serialised: str, w: ca.SX) -> ca.SX:
    try:
        result = ca.Function.deserialize(serialised)(w)
    except (RuntimeError, TypeError, NotImplementedError) as error:
        raise ProblemError(f"{path}: a function cannot be read ({str(error).strip().splitlines()[-1]})") from error
    return ca.densify(result)
