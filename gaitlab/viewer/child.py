"""One viewing session in a process of its own: `python -m gaitlab.viewer.child DIRECTORY SOCKET`.

viser asks nobody who they are, so it listens on a socket file in a folder that only this user may enter, instead of a
port that everybody on the machine could open. Commands come as lines of JSON on stdin, and the session's state goes out
as lines of JSON on stdout; the process ends with its stdin, so it cannot outlive the web server.
"""

import asyncio
import json
import os
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..errors import GaitlabError
from .playback import SPEEDS
from .session import VIEWS, Session

TICK = 1.0 / 30.0
"""Shortest time between two reports of the state [s]."""


class SocketFileLoop(asyncio.SelectorEventLoop):
    """An event loop whose servers listen on a socket file, whatever host and port they ask for."""

    path = ""

    async def create_server(self, protocol_factory: Any, host: Any = None, port: Any = None, **options: Any) -> Any:
        """Listen on the socket file."""
        del host, port  # Unused.
        kept = {name: value for name, value in options.items() if name in ("start_serving", "ssl", "backlog")}
        return await self.create_unix_server(protocol_factory, self.path, **kept)


class SocketFilePolicy(asyncio.DefaultEventLoopPolicy):
    """Makes such loops, also in viser's thread."""

    def new_event_loop(self) -> asyncio.AbstractEventLoop:
        """A new loop."""
        return SocketFileLoop()


def state_of(session: Session) -> dict[str, Any]:
    """What the page beside the 3D view wants to know."""
    return {
        "trial": session.trial,
        "time": round(session.time, 4),
        "frame": session.frame,
        "phase": session.phase,
        "playing": session.playing,
        "speed": session.speed,
    }


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError("not a number")
    return float(value)


COMMANDS: Mapping[str, Callable[[Session, Any], None]] = {
    "seek": lambda session, value: session.seek(_number(value)),
    "play": lambda session, value: session.play(value is True),
    "speed": lambda session, value: session.set_speed(min(max(_number(value), min(SPEEDS.values())), 1.0)),
    "follow": lambda session, value: session.set_follow(value is True),
    "select": lambda session, value: session.select(str(value)) if str(value) in session.trials else None,
    "look": lambda session, value: session.look(str(value)) if str(value) in VIEWS else None,
    "show": lambda session, value: session.set_layer(str(value), True),
    "hide": lambda session, value: session.set_layer(str(value), False),
}
"""What may be asked for, by name."""


def obey(session: Session, line: str) -> None:
    """Carry out a line such as `{"seek": 0.5}`; what is not understood is left, because the asker may be newer."""
    with suppress(ValueError, TypeError, RecursionError):
        wanted = json.loads(line)
        for name, value in wanted.items() if isinstance(wanted, dict) else ():
            if name in COMMANDS:
                COMMANDS[name](session, value)


def _report(session: Session, say: Callable[[str], None], ended: threading.Event) -> None:
    said: dict[str, Any] = {}
    while not ended.wait(TICK):
        state = state_of(session)
        if state != said:
            said = state
            say(json.dumps(state))


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def listen_on(socket: str) -> None:
    """Make every server of this process listen on a socket file that only this user may open."""
    os.umask(0o077)
    SocketFileLoop.path = socket
    # viser makes its loop by asyncio.new_event_loop(), for which a policy is the only way in; gone with Python 3.16.
    asyncio.set_event_loop_policy(SocketFilePolicy())  # pyright: ignore[reportDeprecated]


def main(arguments: list[str]) -> int:
    """Serve until stdin ends; the first line on stdout tells the trials, or why there is nothing to show."""
    directory, socket = arguments
    listen_on(socket)
    try:
        session = Session(Path(directory), port=0)
    except GaitlabError as error:
        _say(json.dumps({"error": str(error).replace(directory, "the result")}))
        return 1
    ended = threading.Event()
    session.hide_controls()
    with session:
        _say(json.dumps({"trials": session.trials}))
        reporter = threading.Thread(target=_report, args=(session, _say, ended), daemon=True)
        reporter.start()
        for line in sys.stdin:
            obey(session, line)
        ended.set()
        reporter.join()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
