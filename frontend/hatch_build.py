"""Hatch's hook: a wheel holds the built pages; an editable installation leaves building them to `make frontend`."""

import os
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).resolve().parent))
from build_frontend import TARGET, build


class FrontendHook(BuildHookInterface):
    """Builds the pages before the files of the wheel are collected."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build, unless this is an editable installation or pages are not wanted."""
        if version == "editable":
            self.app.display_info("editable installation: `make frontend` builds the web pages; until then API only")
            return
        if os.environ.get("GAITLAB_FRONTEND") == "skip":
            self.app.display_warning("GAITLAB_FRONTEND=skip: the wheel holds no web pages, `gaitlab serve` is API only")
            return
        build()
        # The folder is not under version control, so hatch would leave it out.
        build_data["artifacts"].append(f"/gaitlab/{TARGET.name}/")
