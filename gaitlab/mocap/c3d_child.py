"""The process that parses one C3D file: `python -m gaitlab.mocap.c3d_child FILE RESULT MEMORY SECONDS`."""

import math
import resource
import sys
from pathlib import Path

from gaitlab.mocap.c3d import extract
from gaitlab.mocap.raw import save_raw


def main(arguments: list[str]) -> None:
    """Sets the limits, parses the file, writes the result; whatever goes wrong ends the process."""
    source, target, memory, seconds = arguments
    limit_process(int(memory), float(seconds))
    save_raw(Path(target), extract(Path(source)))


def limit_process(memory: int, seconds: float) -> None:
    """Bounds this process: address space [bytes], processor time [s], no core file."""
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(seconds), math.ceil(seconds) + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


if __name__ == "__main__":
    main(sys.argv[1:])
