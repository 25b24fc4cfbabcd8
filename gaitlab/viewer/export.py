"""A trial in 3D as one HTML page: `python -m gaitlab.viewer.export DIRECTORY FILE`, in a process of its own."""

import sys
import tempfile
from pathlib import Path

from ..errors import GaitlabError, OutputError
from .child import listen_on
from .session import Session


def export_html(directory: Path, path: Path, trial: str = "") -> None:
    """Write one trial of an output directory as a page that plays it without a server.

    Args:
        directory: Written by `gaitlab analyse`.
        path: The page.
        trial: Name of the trial; empty: the first.

    Raises:
        OutputError: There is nothing to show, no such trial, or the page cannot be written.
    """
    with Session(directory, port=0) as session:
        if trial and trial not in session.trials:
            raise OutputError(f"{directory} has no trial '{trial}'; available: {', '.join(session.trials)}")
        if trial:
            session.select(trial)
        page = session.recording()
    try:
        path.write_text(page, encoding="utf-8")
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error


def main(arguments: list[str]) -> int:
    """Export without opening a port; one sentence on stderr if that fails."""
    directory, path, *trial = arguments
    with tempfile.TemporaryDirectory(prefix="gaitlab-") as folder:
        listen_on(str(Path(folder) / "viser"))
        try:
            export_html(Path(directory), Path(path), *trial)
        except GaitlabError as error:
            sys.stderr.write(str(error).replace(directory, "the result") + "\n")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
