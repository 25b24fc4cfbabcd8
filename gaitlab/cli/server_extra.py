"""Modules of the server, which need packages that the plain installation lacks."""

import importlib
from typing import Any

from ..errors import OutputError


def load(module: str) -> Any:
    """A module of this package that imports the server's packages.

    Raises:
        OutputError: The extra is not installed.
    """
    try:
        return importlib.import_module(f"{__package__}.{module}")
    except ModuleNotFoundError as error:
        raise OutputError(f"this command needs the package {error.name}: pip install 'gaitlab[server]'") from error
