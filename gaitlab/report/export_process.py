"""Exports in a process of their own: `python -m gaitlab.report.export_process DIRECTORY OUT FORMAT [RECORDING ...]`.

For servers, which keep native readers of C3D files out of their process. The names of the written files go to stdout,
one a line; a sentence on what went wrong to stderr.
"""

import sys
from pathlib import Path

from ..errors import GaitlabError
from .exports import Export, export


def main(arguments: list[str]) -> int:
    """Export; 1 with a sentence, without the folders of this machine, where that is not possible."""
    directory, out, kind, *recordings = arguments
    job = Export(directory=Path(directory), out=Path(out), recordings=tuple(Path(each) for each in recordings))
    try:
        written, _ = export(job, [kind])
    except GaitlabError as error:
        sentence = str(error)
        for path in (*(str(Path(each).parent) for each in recordings), out, directory):
            sentence = sentence.replace(f"{path}/", "").replace(path, "the result")
        sys.stderr.write(sentence + "\n")
        return 1
    sys.stdout.write("".join(f"{path.name}\n" for path in written))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
