"""The command `gaitlab`."""

import importlib
import os
import sys

# Linear algebra on small blocks: more threads only wait for each other. To be said before NumPy and CasADi load.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

SERVER = ("serve", "worker", "doctor", "backup", "restore", "retention", "export-patient", "key")
"""Commands that start without loading what computes."""


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; `arguments` default to those of the process."""
    words = sys.argv[1:] if arguments is None else arguments
    module = "server_app" if words[:1] and words[0] in SERVER else "app"
    importlib.import_module(f".{module}", __package__).main(arguments)


__all__ = ["main"]
