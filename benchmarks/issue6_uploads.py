"""Issue 6, line 3: ten thousand damaged recordings, sent one after the other, and the memory of very large uploads."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

from hostile_uploads import look_into, send_mutated
from large_upload import WAYS, memory_of_upload
from registry import Row, measurement
from web_world import world_in_a_process

UPLOADS, LOOKED_INTO, STUCK = 10_000, 300, 3600.0
"""Files, jobs that a worker runs to their end, longest time for these [s]."""


@measurement(issue=6, line=3)
def mutated_uploads() -> Iterator[Row]:
    with (
        tempfile.TemporaryDirectory(prefix="gaitlab-hostile-") as folder,
        world_in_a_process(Path(folder)) as (world, process),
    ):
        report = send_mutated(world, process, UPLOADS)
        left = look_into(world, LOOKED_INTO, STUCK)
    subject = f"{UPLOADS} mutated C3D files"
    yield Row(quantity="uploads", value=report.statuses.total(), limit=">= 10000", unit="", subject=subject)
    yield Row(quantity="taken", value=report.taken, limit="", unit="", subject=subject)
    yield Row(quantity="refused", value=report.refused, limit="", unit="", subject=subject)
    for quantity, value in (
        ("answers but 201, 413, 422", len(report.unexpected)),
        ("crashes of the web process", 0 if report.alive else 1),
        ("half-written files left", report.spooled),
    ):
        yield Row(quantity=quantity, value=value, limit="<= 0", unit="", subject=subject)
    yield Row(quantity="file handles more than before", value=report.handles, limit="<= 5", unit="", subject=subject)
    yield Row(quantity="stuck jobs", value=left, limit="<= 0", unit="", subject=f"{LOOKED_INTO} of the jobs")


@measurement(issue=6, line=3)
def memory_of_large_uploads() -> Iterator[Row]:
    with tempfile.TemporaryDirectory(prefix="gaitlab-large-") as folder:
        for way in WAYS:
            with world_in_a_process(Path(folder)) as (world, process):
                used = memory_of_upload(world, process, way) / 1e6
            yield Row(
                quantity="more memory than before", value=used, limit="<= 100", unit="MB", subject=f"500 MB, {way}"
            )
