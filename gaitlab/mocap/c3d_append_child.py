"""The process that appends: `python -m gaitlab.mocap.c3d_append_child FILE OUTPUTS TARGET MEMORY SECONDS`."""

import sys
from pathlib import Path

from gaitlab.mocap.c3d_append import append_here
from gaitlab.mocap.c3d_child import limit_process
from gaitlab.mocap.point_output import load_outputs


def main(arguments: list[str]) -> None:
    """Sets the limits, writes the copy; whatever goes wrong ends the process."""
    source, outputs, target, memory, seconds = arguments
    limit_process(int(memory), float(seconds))
    append_here(Path(source), load_outputs(Path(outputs)), Path(target))


if __name__ == "__main__":
    main(sys.argv[1:])
