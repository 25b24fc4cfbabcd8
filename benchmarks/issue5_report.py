"""Issue 5, line 3: time of a report of five trials without weights, and its size."""

import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from registry import CHILDREN, Row, measurement
from vicon import recording

from gaitlab.pipelines.analyse import analyse
from gaitlab.pipelines.options import AnalysisOptions
from gaitlab.pipelines.output import write_analysis
from gaitlab.report.build import ReportOptions
from gaitlab.report.files import ReportFolders, draft_report

CHILD = CHILDREN[3]
KINDS = ("straight", "turn", "straight", "turn", "straight")
REPEATS = 3


@measurement(issue=5, line=3)
def report_of_five_trials() -> Iterator[Row]:
    static = recording(f"children/{CHILD}/static_*.c3d")
    walks = [
        replace(recording(f"children/{CHILD}/{kind}_*.c3d"), name=f"walk{number}")
        for number, kind in enumerate(KINDS, 1)
    ]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        start, used = time.perf_counter(), time.process_time()
        write_analysis(analyse(static, walks, AnalysisOptions(weights=False)), folder)
        analysis, analysis_used = time.perf_counter() - start, time.process_time() - used
        seconds, processor = list[float](), list[float]()
        for _ in range(REPEATS):
            start, used = time.perf_counter(), time.process_time()
            paths = draft_report(ReportFolders(results=folder, report=folder), ReportOptions())
            seconds.append(time.perf_counter() - start)
            processor.append(time.process_time() - used)
        sizes = {path.suffix[1:]: path.stat().st_size / 1e6 for path in paths}
    report, report_used = sorted(seconds)[REPEATS // 2], sorted(processor)[REPEATS // 2]
    subject = f"{CHILD}, {len(walks)} trials"
    yield Row(quantity="report, PDF and HTML", value=report, limit="<= 10", unit="s", subject=subject)
    yield Row(quantity="report, processor time", value=report_used, limit="<= 10", unit="s", subject=subject)
    yield Row(quantity="analysis and report", value=analysis + report, limit="", unit="s", subject=subject)
    yield Row(
        quantity="analysis and report, processor time",
        value=analysis_used + report_used,
        limit="",
        unit="s",
        subject=subject,
    )
    for ending, size in sizes.items():
        yield Row(quantity=f"size of the report, {ending}", value=size, limit="<= 5", unit="MB", subject=subject)
