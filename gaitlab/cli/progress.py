"""Progress bars."""

from collections.abc import Generator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn

from ..pipelines import progress


class ProgressBars:
    """One bar per stage of each recording; a stage that reports no part done shows iteration and residual."""

    def __init__(self, bars: Progress) -> None:
        self._bars = bars
        self._tasks: dict[str, TaskID] = {}

    def __call__(self, step: progress.Step) -> None:
        """Show one report."""
        title = f"{step.trial}: {step.stage}" if step.trial else step.stage
        if title not in self._tasks:
            self.finish()
            self._tasks[title] = self._bars.add_task(title, total=None, detail="")
        total = None if step.done is None else 1.0
        self._bars.update(self._tasks[title], detail=_detail(step), total=total, completed=step.done)

    def finish(self) -> None:
        """Fill every bar."""
        for task in self._tasks.values():
            self._bars.update(task, total=1.0, completed=1.0)


@contextmanager
def progress_bars() -> Generator[ProgressBars]:
    """Bars on stderr while the block runs."""
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[detail]}"))
    with Progress(*columns, TimeElapsedColumn(), console=Console(stderr=True)) as bars:
        shown = ProgressBars(bars)
        yield shown
        shown.finish()


def _detail(step: progress.Step) -> str:
    parts = [] if step.iteration is None else [f"iteration {step.iteration}"]
    parts += [] if step.residual is None else [f"residual {step.residual:.1e}"]
    return ", ".join(parts)
