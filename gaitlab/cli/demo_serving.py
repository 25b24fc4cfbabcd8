"""`gaitlab demo-clinic`: the web application with the demo patients in it."""

import json
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

import psutil
import typer

from ..errors import OutputError
from ..storage.files import open_store
from ..storage.settings import Settings
from . import service
from .demo_patients import LOGINS, PASSWORD, add_demo_patients
from .given_settings import settings_of
from .serving import serve

READY_SECONDS = 120.0
PROGRAM = "from gaitlab.cli import main; main()"
LOG, RUNNING = "serve.log", "demo.json"


def serve_demo(data_dir: Path, child: str, results: Path, port: int) -> None:
    """Fill the data folder, then serve: in a terminal until Ctrl+C, elsewhere in the background.

    Raises:
        OutputError: There is no result, or the server does not start.
    """
    given = {"data_dir": data_dir, "host": "127.0.0.1", "port": port, "log_format": "text"}
    address = _running_at(data_dir)
    if address:
        _tell(f"the demo runs already: {address}")
        return
    _fill(settings_of(given), child, results)
    _tell(f"sign in as {' or '.join(LOGINS)} with the password {PASSWORD}")
    if sys.stdout.isatty():
        _tell("Ctrl+C ends it")
        serve(given)
        return
    process = _start(data_dir, port)
    address = _wait_until_ready(process, data_dir)
    (data_dir / RUNNING).write_text(json.dumps({"pid": process.pid, "address": address}))
    _tell(f"gaitlab: {address}")
    _tell(f"it runs in the background, log in {data_dir / LOG}; to end it: kill {process.pid}")


def _tell(sentence: str) -> None:
    typer.echo(sentence)


def _running_at(data_dir: Path) -> str:
    """Address of a demo that was left in the background, if it is still there."""
    with suppress(OSError, ValueError, KeyError, psutil.Error):
        noted = json.loads((data_dir / RUNNING).read_text())
        if "gaitlab" in " ".join(psutil.Process(noted["pid"]).cmdline()):
            return str(noted["address"])
    return ""


def _fill(settings: Settings, child: str, results: Path) -> None:
    with service.running_database(settings) as (url, _):
        service.prepare(settings, url)
        with service.opened(url) as database:
            add_demo_patients(database, open_store(settings), child, results)


def _start(data_dir: Path, port: int) -> "subprocess.Popen[bytes]":
    command = [sys.executable, "-P", "-c", PROGRAM, "serve", "--data-dir", str(data_dir)]
    command += ["--host", "127.0.0.1", "--port", str(port), "--log-format", "text"]
    with (data_dir / LOG).open("wb") as log:
        # Nothing of ours stays open in it, so that whoever reads our output sees its end.
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True)


def _wait_until_ready(process: "subprocess.Popen[bytes]", data_dir: Path) -> str:
    deadline = time.monotonic() + READY_SECONDS
    while time.monotonic() < deadline and process.poll() is None:
        told = [line for line in (data_dir / LOG).read_text().splitlines() if line.startswith("gaitlab: http")]
        with suppress(URLError, OSError):
            if told and urlopen(f"{told[-1].split()[1]}/health/ready", timeout=5).status == 200:
                return told[-1].split()[1]
        time.sleep(0.2)
    process.terminate()
    raise OutputError(f"the web application did not start; {data_dir / LOG} tells why")
