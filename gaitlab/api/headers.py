"""Security headers of every answer, and the two content security policies: the pages' and the 3D viewer's."""

from collections.abc import Iterable

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

PAGES = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        # Component libraries and uPlot set style attributes at run time.
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "media-src 'self' blob:",
        "font-src 'self' data:",
        "connect-src 'self'",
        "worker-src 'self' blob:",
        "frame-src 'self' blob:",
        "manifest-src 'self'",
        "base-uri 'none'",
        "form-action 'self'",
        "frame-ancestors 'none'",
    )
)
VIEWER = "; ".join(
    (
        # viser's client is one page with its script, styles, worker and WebAssembly inside, and makes functions of
        # strings at run time: without leave to, Chromium reports an error in it.
        "default-src 'none'",
        "script-src 'self' 'unsafe-inline' 'unsafe-eval' blob:",
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "font-src 'self' data:",
        "connect-src 'self' data: blob:",
        "worker-src 'self' blob:",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'self'",
    )
)
DOCUMENT = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; sandbox"
"""Of stored reports that a browser opens by themselves."""
SCENE = VIEWER + "; sandbox allow-scripts"
"""Of an exported scene: its script runs, but in an origin of its own, without our cookies."""
_ALWAYS = {
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), geolocation=(), microphone=(), payment=(), usb=()",
}
_TLS_ONLY = "max-age=63072000; includeSubDomains"


class SecurityHeaders:
    """Adds what an answer does not say by itself; answers of the API are kept out of every cache but the asker's."""

    def __init__(self, app: ASGIApp, tls: bool, uncached: Iterable[str]) -> None:
        self._app, self._tls, self._uncached = app, tls, tuple(uncached)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one connection."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                self._complete(MutableHeaders(scope=message), str(scope["path"]))
            await send(message)

        await self._app(scope, receive, send_with_headers)

    def _complete(self, headers: MutableHeaders, path: str) -> None:
        for name, value in _ALWAYS.items():
            headers.setdefault(name, value)
        headers.setdefault("content-security-policy", PAGES)
        if "frame-ancestors 'self'" not in headers["content-security-policy"]:
            headers.setdefault("x-frame-options", "DENY")
        if self._tls:
            headers.setdefault("strict-transport-security", _TLS_ONLY)
        if path.startswith(self._uncached):
            headers.setdefault("cache-control", "private, no-cache")
