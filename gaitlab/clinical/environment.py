"""Versions and machine that a result was computed with; never the machine's name or its user."""

import os
import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version

from .. import __version__


def environment(packages: Sequence[str]) -> dict[str, str]:
    """gaitlab, Python, operating system, processors, and those of the packages that are installed, by name."""
    found = {
        "gaitlab": __version__,
        "Python": platform.python_version(),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
        "processors": str(os.cpu_count() or "not known"),
    }
    for package in packages:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found
