import subprocess
import sys


def test_the_child_starts_without_the_heavy_libraries():
    code = (
        "import sys, gaitlab.mocap.c3d_child; "
        "print([m for m in ('casadi', 'pinocchio', 'scipy', 'matplotlib', 'viser') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
