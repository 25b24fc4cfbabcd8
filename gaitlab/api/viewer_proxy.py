"""Passes HTTP and WebSocket between a browser and the process of its 3D session."""

import asyncio
import contextlib
from collections.abc import Awaitable

import httpx
from fastapi import Request, WebSocket, WebSocketDisconnect
from starlette.responses import Response
from websockets.asyncio.client import ClientConnection, unix_connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake
from websockets.typing import Subprotocol

from .headers import VIEWER
from .viewers import Viewer

LONGEST_MESSAGE = 50 << 20
"""Bytes; as viser's own limit, which pictures need."""
LONGEST_COMMAND = 4096
ENDED = 4001
"""Close code: the 3D session has ended, or its owner has signed out."""
_KEPT = ("content-type", "content-encoding", "content-length")


async def fetch(viewer: Viewer, request: Request, path: str) -> Response:
    """A file of viser's client."""
    transport = httpx.AsyncHTTPTransport(uds=str(viewer.socket))
    encodings = request.headers.get("accept-encoding", "identity")
    async with (
        viewer.attached(),
        httpx.AsyncClient(transport=transport, base_url="http://viewer") as client,
        client.stream("GET", f"/{path}", headers={"accept-encoding": encodings}) as answer,
    ):
        body = b"".join([piece async for piece in answer.aiter_raw()])
    headers = {name: answer.headers[name] for name in _KEPT if name in answer.headers}
    headers |= {"content-security-policy": VIEWER, "cache-control": "private, no-cache"}
    return Response(body, answer.status_code, headers)


async def connect(viewer: Viewer, browser: WebSocket) -> None:
    """Join a browser's WebSocket and the process's until either ends, or the session does."""
    wanted = [Subprotocol(name) for name in browser.scope.get("subprotocols", [])]
    try:
        async with (
            viewer.attached(),
            unix_connect(
                str(viewer.socket),
                "ws://viewer/",
                subprotocols=wanted or None,
                max_size=LONGEST_MESSAGE,
                compression=None,
            ) as inner,
        ):
            await browser.accept(inner.subprotocol)
            await _first_of(_to_browser(inner, browser), _from_browser(browser, inner), viewer.ended.wait())
    except (OSError, InvalidHandshake):
        # The process has ended a moment ago.
        viewer.ended.set()
    await _close(browser)


async def control(viewer: Viewer, browser: WebSocket) -> None:
    """Pass commands to the process and its states to the page beside the 3D view."""
    queue: asyncio.Queue[str] = asyncio.Queue(4)
    await browser.accept()
    if viewer.state:
        queue.put_nowait(viewer.state)
    viewer.listeners.add(queue)
    try:
        async with viewer.attached():
            await _first_of(_tell(queue, browser), _obey(browser, viewer), viewer.ended.wait())
    finally:
        viewer.listeners.discard(queue)
    await _close(browser)


async def _tell(queue: "asyncio.Queue[str]", browser: WebSocket) -> None:
    while True:
        await browser.send_text(await queue.get())


async def _obey(browser: WebSocket, viewer: Viewer) -> None:
    while True:
        line = await browser.receive_text()
        if len(line) <= LONGEST_COMMAND:
            await viewer.command(line)


async def _to_browser(inner: ClientConnection, browser: WebSocket) -> None:
    async for message in inner:
        if isinstance(message, bytes):
            await browser.send_bytes(message)
        else:
            await browser.send_text(message)


async def _from_browser(browser: WebSocket, inner: ClientConnection) -> None:
    while True:
        message = await browser.receive()
        if message["type"] == "websocket.disconnect":
            return
        data = message.get("bytes")
        await inner.send(message["text"] if data is None else data)


async def _first_of(*works: Awaitable[object]) -> None:
    """Run until one of them ends; then end the others."""
    tasks = [asyncio.ensure_future(work) for work in works]
    try:
        await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for task in tasks:
            task.cancel()
        for outcome in await asyncio.gather(*tasks, return_exceptions=True):
            if isinstance(outcome, Exception) and not isinstance(outcome, _USUAL):
                raise outcome


_USUAL = (ConnectionClosed, WebSocketDisconnect, RuntimeError, KeyError, OSError)
"""How a connection ends: either side went away, also in the middle of a message."""


async def _close(browser: WebSocket) -> None:
    with contextlib.suppress(RuntimeError, WebSocketDisconnect):
        await browser.close(ENDED)
