"""The built frontend: its files, and its one page for every address that is no file."""

from pathlib import Path

from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

FRONTEND = Path(__file__).resolve().parents[1] / "frontend_dist"
"""Where the build puts it."""
FOREVER = "public, max-age=31536000, immutable"
"""Files below assets/ have a hash in their name."""


class Frontend(StaticFiles):
    """Serves a single-page application."""

    def __init__(self, folder: Path) -> None:
        super().__init__(directory=folder, html=True)

    async def get_response(self, path: str, scope: Scope) -> Response:
        """A file, or the page for addresses that the page itself understands."""
        try:
            response = await super().get_response(path, scope)
        except HTTPException as error:
            if (
                error.status_code != 404
                or path.startswith(("api/", "assets/"))
                or scope["method"] not in ("GET", "HEAD")
            ):
                raise
            response = await super().get_response("index.html", scope)
        if path.startswith("assets/"):
            response.headers["cache-control"] = FOREVER
        else:
            response.headers["cache-control"] = "no-cache"
        return response
