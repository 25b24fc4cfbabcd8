"""The command `gaitlab`."""

import os

# Linear algebra on small blocks: more threads only wait for each other. To be said before NumPy and CasADi load.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

from .app import main  # noqa: E402

__all__ = ["main"]
