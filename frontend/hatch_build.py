"""Hatch's hook: builds the web pages, for a wheel and for an editable installation."""

import os
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).resolve().parent))
from build_frontend import TARGET, BuildError, build


class FrontendHook(BuildHookInterface):
    """Builds the pages before the files of the wheel are collected."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build, unless this is an editable installation or pages are not wanted."""
        if os.environ.get("GAITLAB_FRONTEND") == "skip":
            self.app.display_warning("GAITLAB_FRONTEND=skip: the wheel holds no web pages, `gaitlab serve` is API only")
            return
        if version == "editable":
            _build_if_possible(self)
            return
        build()
        # The folder is not under version control, so hatch would leave it out.
        build_data["artifacts"].append(f"/gaitlab/{TARGET.name}/")


def _build_if_possible(hook: FrontendHook) -> None:
    """A developer may be without a registry of npm, or amid a change; `make frontend` then says what is wrong."""
    try:
        build()
    except BuildError as error:
        hook.app.display_warning(f"no web pages, API only until `make frontend`: {error}")
