"""An S3-compatible server of its own, SeaweedFS, on this machine: it checks signatures and takes uploads in parts."""

import json
import os
import secrets
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from contextlib import ExitStack, contextmanager
from pathlib import Path

PROGRAM = Path(sys.executable).parent / "weed"
STARTS_WITHIN = 60.0
SERVICES = ("master", "volume", "filer", "s3")


def free_ports(count):
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.create_server(("127.0.0.1", 0))) for _ in range(count)]
        return [each.getsockname()[1] for each in sockets]


@contextmanager
def running_s3(folder):
    """Variables of the environment by which a client reaches the server; its data lie in `folder`."""
    secret, ports = secrets.token_hex(16), free_ports(2 * len(SERVICES))
    person = {"credentials": [{"accessKey": "gaitlab", "secretKey": secret}], "actions": ["Admin", "Read", "Write"]}
    (folder / "s3.json").write_text(json.dumps({"identities": [{"name": "gaitlab", **person}]}))
    command = [str(PROGRAM), "server", f"-dir={folder}", "-ip=127.0.0.1", "-ip.bind=127.0.0.1", "-s3"]
    for number, name in enumerate(SERVICES):
        command += [f"-{name}.port={ports[2 * number]}", f"-{name}.port.grpc={ports[2 * number + 1]}"]
    command += ["-s3.port.iceberg=0", "-s3.port.lance=0", f"-s3.config={folder}/s3.json", "-master.telemetry=false"]
    command += [f"-{name}.localSocket={folder}/{name}.sock" for name in ("filer", "s3")]
    with (
        (folder / "log").open("wb") as log,
        subprocess.Popen([*command, "-volume.preStopSeconds=0"], stdout=log, stderr=log) as server,
    ):
        try:
            _wait(server, address := f"http://127.0.0.1:{ports[6]}", folder / "log")
            yield {
                "AWS_ENDPOINT": address, "AWS_ALLOW_HTTP": "true", "AWS_REGION": "us-east-1",
                "AWS_ACCESS_KEY_ID": "gaitlab", "AWS_SECRET_ACCESS_KEY": secret,
            }  # fmt: skip
        finally:
            server.kill()


def _wait(server, address, log):
    deadline = time.monotonic() + STARTS_WITHIN
    while server.poll() is None and time.monotonic() < deadline:
        try:
            urllib.request.urlopen(address, timeout=5.0).close()
        except urllib.error.HTTPError as refused:
            # Nobody gets in without a signature.
            assert refused.code == 403
            refused.close()
            return
        except OSError:
            time.sleep(0.1)
    raise RuntimeError(f"the S3 server does not start: {log.read_text()[-1000:]}")


@contextmanager
def environment(values):
    """Set variables of the environment for a while."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
