"""`python served_world.py DATA_DIR DATABASE_URL`: the web process alone, on any port of this machine, to measure it."""

import os
import socket
import sys
from pathlib import Path

import uvicorn

from gaitlab.api.app import create_app
from gaitlab.cli.web_process import KEEP_ALIVE_SECONDS, spare_what_stays
from gaitlab.jobs.logs import configure_logs
from gaitlab.storage.settings import Settings

if __name__ == "__main__":
    data_dir, url = Path(sys.argv[1]), sys.argv[2]
    listener = socket.create_server(("127.0.0.1", 0))
    sys.stdout.write(f"http://127.0.0.1:{listener.getsockname()[1]}\n")
    sys.stdout.flush()
    # Nobody reads the log: a full pipe would stop the process.
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    configure_logs("json")
    app = create_app(Settings(data_dir=data_dir, database_url=url, viewers_per_user=20), data_dir / "none")
    spare_what_stays()
    config = uvicorn.Config(app, log_config=None, access_log=False, timeout_keep_alive=KEEP_ALIVE_SECONDS)
    uvicorn.Server(config).run([listener])
