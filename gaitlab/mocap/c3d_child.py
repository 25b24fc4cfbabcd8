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
    resource.setrlimit(resource.RLIMIT_AS, (int(memory), int(memory)))
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(float(seconds)), math.ceil(float(seconds)) + 1))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    save_raw(Path(target), extract(Path(source)))


if __name__ == "__main__":
    main(sys.argv[1:])
