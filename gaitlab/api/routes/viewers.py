"""3D sessions: opening, reaching, steering and closing them."""

from collections.abc import Callable
from http import HTTPStatus
from pathlib import Path
from typing import Annotated
from uuid import UUID

from fastapi import Request, Response, WebSocket
from starlette.concurrency import run_in_threadpool

from ...errors import AccessDenied
from .. import visibility
from ..dependencies import Asker, allowed_slowly, asker_of
from ..files import content
from ..origin import is_same_origin
from ..permissions import Permission
from ..problems import Absent
from ..results import SHOWN, copy_files, files_of
from ..routing import api_router
from ..schemas.work import Viewer
from ..viewer_proxy import connect, control, fetch
from ..viewers import Owner
from ..viewers import Viewer as Running

REFUSED = 4003
router = api_router(tag="3D sessions")
Looker = Annotated[Asker, allowed_slowly(Permission.RESULTS_READ)]


def owner_of(asker: Asker) -> Owner:
    """Who may look at what this asker opens."""
    caller = asker.caller
    return Owner(user_id=caller.user_id, web_session_id=caller.web_session_id, token_id=caller.token_id)


def _answer(viewer: Running) -> Viewer:
    base = f"/api/v1/viewers/{viewer.id}"
    return Viewer(
        id=viewer.id,
        result_id=viewer.result_id,
        url=f"{base}/view/",
        control=f"{base}/control",
        trials=viewer.trials,
    )


@router.post("/results/{result_id}/viewer", status_code=HTTPStatus.CREATED)
async def open_viewer(asker: Looker, result_id: UUID) -> Viewer:
    """Start a 3D session on a result; it ends when it is closed, left alone, or its owner signs out."""
    fill = await run_in_threadpool(_filler, asker, result_id)
    return _answer(await asker.services.viewers.open(owner_of(asker), result_id, fill))


def _filler(asker: Asker, result_id: UUID) -> Callable[[Path], None]:
    with asker.begin() as call:
        result = visibility.result(call, result_id, "view")
        files = [file for file in files_of(call, result.id) if Path(file.name).name in SHOWN]
    return lambda folder: copy_files(asker.services, files, folder)


def _viewer(asker: Asker, viewer_id: str) -> Running:
    found = asker.services.viewers.get(viewer_id, owner_of(asker))
    if found is None:
        raise Absent("3D session", viewer_id[:40])
    return found


@router.get("/viewers/{viewer_id}")
async def get_viewer(asker: Looker, viewer_id: str) -> Viewer:
    """A running 3D session of one's own."""
    return _answer(_viewer(asker, viewer_id))


@router.delete("/viewers/{viewer_id}", status_code=HTTPStatus.NO_CONTENT)
async def close_viewer(asker: Looker, viewer_id: str) -> None:
    """End a 3D session of one's own."""
    await asker.services.viewers.close(_viewer(asker, viewer_id))


@router.get("/viewers/{viewer_id}/view/{path:path}", response_class=Response, responses=content("text/html"))
async def show_viewer(request: Request, asker: Looker, viewer_id: str, path: str) -> Response:
    """The page of a 3D session."""
    return await fetch(_viewer(asker, viewer_id), request, path)


@router.websocket("/viewers/{viewer_id}/view")
@router.websocket("/viewers/{viewer_id}/view/")
async def join_viewer(browser: WebSocket, viewer_id: str) -> None:
    """The stream between the page of a 3D session and its process."""
    viewer = await _admit(browser, viewer_id)
    if viewer is not None:
        await connect(viewer, browser)


@router.websocket("/viewers/{viewer_id}/control")
async def control_viewer(browser: WebSocket, viewer_id: str) -> None:
    """Commands to a 3D session, such as `{"seek": 0.5}`, and its states, such as `{"time": 0.5, "frame": 50}`."""
    viewer = await _admit(browser, viewer_id)
    if viewer is not None:
        await control(viewer, browser)


async def _admit(browser: WebSocket, viewer_id: str) -> Running | None:
    """The session, if the browser is its owner's and the page is ours; otherwise the door stays shut."""
    try:
        if not is_same_origin(browser):
            raise AccessDenied("a page of another site asks")
        asker = await run_in_threadpool(asker_of, browser, Permission.RESULTS_READ)
        return _viewer(asker, viewer_id)
    except (AccessDenied, Absent):
        await browser.close(REFUSED)
        return None
