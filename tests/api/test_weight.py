"""The web process starts quickly and stays small: it loads neither solvers nor readers nor filters."""

import json
import subprocess
import sys

HEAVY = ("casadi", "ezc3d", "joserfc", "matplotlib", "pinocchio", "pandas", "scipy", "typst", "viser")
SCRIPT = "import json, sys, gaitlab.cli.web_process; print(json.dumps(sorted(sys.modules)))"


def test_the_web_process_loads_nothing_heavy():
    loaded = json.loads(subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, check=True).stdout)
    assert "gaitlab.api.app" in loaded and set(HEAVY).isdisjoint(loaded)
