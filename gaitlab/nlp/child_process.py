"""A Python process that answers requests, for native code that may crash, hang or ask for all the memory there is.

Messages are pickles between a process and its own child, each preceded by its length in eight bytes.
"""

import math
import os
import pickle
import resource
import select
import signal
import struct
import subprocess
import sys
import time
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, BinaryIO

LENGTH = struct.Struct("<Q")
LARGEST = 1 << 32
"""No message is longer [bytes]: a length beyond it is noise."""
GRACE = 5.0
"""Processor time that a child may take beyond its wall time before the system ends it [s]."""


@dataclass(frozen=True, kw_only=True)
class ChildFailure:
    """A child that did not answer."""

    reason: str
    timed_out: bool


class ChildProcess:
    """Runs `python -m module`, sends it `setup` once, then one message a request. Restarts it after its death."""

    def __init__(self, module: str, setup: object, memory: int) -> None:
        self._module, self._setup, self._memory = module, setup, memory
        self._process: subprocess.Popen[bytes] | None = None

    def ask(self, request: object, seconds: float) -> Any:
        """Answer to a request, or `ChildFailure` when none comes within `seconds`."""
        deadline = time.monotonic() + seconds
        try:
            process = self._running()
            _send(process.stdin, (request, seconds))
            return pickle.loads(_receive(process.stdout, deadline))
        except TimeoutError:
            self.close()
            return ChildFailure(reason=f"no end within {seconds:g} s", timed_out=True)
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            return self._post_mortem(seconds)

    def close(self) -> None:
        """End the child."""
        if self._process is not None:
            _end(self._process)
            self._process = None

    def _running(self) -> "subprocess.Popen[bytes]":
        if self._process is not None and self._process.poll() is None:
            return self._process
        environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")  # threads cost address space
        command = [sys.executable, "-P", "-m", self._module, str(self._memory)]
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, env=environment)
        weakref.finalize(self, _end, self._process)
        _send(self._process.stdin, self._setup)
        return self._process

    def _post_mortem(self, seconds: float) -> ChildFailure:
        process, self._process = self._process, None
        if process is None:
            return ChildFailure(reason="the process could not be started", timed_out=False)
        code = process.wait()
        _end(process)
        if code == -signal.SIGXCPU:
            return ChildFailure(reason=f"no end within {seconds:g} s", timed_out=True)
        if code < 0:
            return ChildFailure(reason=f"the process crashed ({signal.Signals(-code).name})", timed_out=False)
        return ChildFailure(reason=f"the process ended with code {code}", timed_out=False)


def serve(prepare: Callable[[Any], Callable[[Any], object]]) -> None:
    """Body of a child's module: `prepare(setup)` returns the function that answers requests."""
    memory = int(sys.argv[1])
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # Native code prints to descriptor 1; the answers go to a copy of it that nobody else knows.
    with os.fdopen(os.dup(1), "wb") as answers, os.fdopen(os.dup(0), "rb") as requests:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        answer = prepare(pickle.loads(_receive(requests, math.inf)))
        while True:
            try:
                request, seconds = pickle.loads(_receive(requests, math.inf))
            except EOFError:
                return
            _limit_processor_time(seconds + GRACE)
            _send(answers, answer(request))


def _limit_processor_time(seconds: float) -> None:
    # A parent that was killed cannot end a child that loops.
    used = resource.getrusage(resource.RUSAGE_SELF)
    limit = math.ceil(used.ru_utime + used.ru_stime + min(seconds, 1e8))
    resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.getrlimit(resource.RLIMIT_CPU)[1]))


def _send(stream: BinaryIO | Any, message: object) -> None:
    data = pickle.dumps(message)
    stream.write(LENGTH.pack(len(data)) + data)
    stream.flush()


def _receive(stream: BinaryIO | Any, deadline: float) -> bytes:
    (length,) = LENGTH.unpack(_read(stream, LENGTH.size, deadline))
    if length > LARGEST:
        raise EOFError
    return _read(stream, length, deadline)


def _read(stream: BinaryIO, size: int, deadline: float) -> bytes:
    data = b""
    while len(data) < size:
        if math.isfinite(deadline):
            left = deadline - time.monotonic()
            if left <= 0.0 or not select.select([stream], [], [], left)[0]:
                raise TimeoutError
        part = os.read(stream.fileno(), min(size - len(data), 1 << 20))
        if not part:
            raise EOFError
        data += part
    return data


def _end(process: "subprocess.Popen[bytes]") -> None:
    process.kill()
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            try:
                stream.close()
            except BrokenPipeError:
                continue
    process.wait()
