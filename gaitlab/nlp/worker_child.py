"""What a process of `workers.Workers` runs: tasks in, results or exceptions out, until its input ends."""

import os
import pickle
import sys
from typing import Any

from ..errors import GaitlabError


def main() -> None:
    """Serve tasks from standard input."""
    results = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    # What a library prints must not get between the results.
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    while True:
        try:
            task: Any = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            outcome: object = task.run()
        except GaitlabError as error:
            outcome = error
        pickle.dump(outcome, results)
        results.flush()


if __name__ == "__main__":
    main()
