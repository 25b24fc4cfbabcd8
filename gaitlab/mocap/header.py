"""Checks of a C3D file that need no parser: is it one, is it of a bearable size, is all of it there?

Source: C3D file format, the 512-byte header section (c3d.org).
"""

import os
import re
import struct
from dataclasses import dataclass
from pathlib import Path

from gaitlab.errors import InvalidRecording

BLOCK = 512  # bytes
MAGIC = 0x50
DEC, MIPS = 85, 86  # processor types; 84 is Intel
LARGEST_PARAMETERS = 256 * BLOCK  # the section's length is one byte


@dataclass(frozen=True, kw_only=True)
class Header:
    """Sizes from the header section of a C3D file."""

    n_points: int
    n_analog: int
    """Analogue values per video frame, all channels together."""
    n_frames: int
    """Stored frames; files with more than 65535 frames say less."""
    data_start: int
    """First byte of the data section."""
    value_size: int
    """Bytes per stored number: 4 for real, 2 for integer files."""

    @property
    def end(self) -> int:
        """File size [bytes] that holds all frames."""
        return self.data_start + self.n_frames * self.value_size * (4 * self.n_points + self.n_analog)


def check_file(path: Path, largest: int) -> None:
    """Raises InvalidRecording unless `path` is a complete C3D file of at most `largest` bytes."""
    try:
        if not path.exists():
            raise InvalidRecording(f"{path}: there is no such file; give the path of a C3D file")
        if not path.is_file():
            raise InvalidRecording(f"{path}: this is not a file; give the path of a C3D file")
        size = path.stat().st_size
        with path.open("rb") as file:
            start = file.read(BLOCK)
            _check_start(path, start, size, largest)
            file.seek((start[0] - 1) * BLOCK, os.SEEK_SET)
            parameters = file.read(LARGEST_PARAMETERS)
    except OSError as error:
        raise InvalidRecording(f"{path}: the file cannot be read ({error.strerror}); check its permissions") from error
    if len(parameters) < 4:
        raise InvalidRecording(f"{path}: the C3D file is truncated before its parameters; copy it again")
    header = parse_header(start, parameters)
    if size < header.end:
        raise InvalidRecording(
            f"{path}: the C3D file is truncated: {size} bytes, but {header.n_frames} frames need {header.end}; "
            "copy it again from where it was recorded"
        )


def _check_start(path: Path, start: bytes, size: int, largest: int) -> None:
    if size == 0:
        raise InvalidRecording(f"{path}: the file is empty; copy it again from where it was recorded")
    if len(start) < 2 or start[1] != MAGIC or start[0] == 0:
        raise InvalidRecording(f"{path}: this is not a C3D file (it does not start as one); export the trial as C3D")
    if size > largest:
        raise InvalidRecording(
            f"{path}: the file has {size / 1e6:.0f} MB, the limit is {largest / 1e6:.0f} MB; cut the trial to the walk"
        )
    if len(start) < BLOCK:
        raise InvalidRecording(f"{path}: the C3D file is truncated inside its header; copy it again")


def parse_header(start: bytes, parameters: bytes) -> Header:
    """Sizes from the header section and the parameter section of a file.

    Byte 3 of the parameter section tells the processor type. The header may keep the frame range of the original
    capture; POINT:FRAMES then states fewer.
    """
    processor = parameters[3]
    order = ">" if processor == MIPS else "<"
    n_points, n_analog, first, last, _ = struct.unpack(order + "5H", start[2:12])
    data_block: int = struct.unpack(order + "H", start[16:18])[0]
    sign_byte = {MIPS: start[12], DEC: start[13]}.get(processor, start[15])  # of the scale factor
    in_range = max(last - first + 1, 0)
    stated = _stated_frames(parameters, order)
    return Header(
        n_points=n_points,
        n_analog=n_analog,
        n_frames=in_range if stated is None else min(stated, in_range),
        data_start=max(data_block - 1, 0) * BLOCK,
        value_size=4 if sign_byte & 0x80 else 2,  # a negative scale factor marks real numbers
    )


def _stated_frames(parameters: bytes, order: str) -> int | None:
    """POINT:FRAMES where it is stored as an integer: name length, group, name, offset (2), type (1), dimensions (1)."""
    found = re.search(rb"[\x06\xfa].FRAMES..\x02\x00(..)", parameters, re.DOTALL)
    return int(struct.unpack(order + "H", found[1])[0]) if found else None
