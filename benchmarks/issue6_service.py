"""Issue 6, line 1: starts of the service, kills at random, and a job that moves to another worker."""

import os
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from statistics import median

import psutil
from registry import Row, measurement
from service_kills import Plan, Service, demo_files, kill_at_random

PORT = 18765
PLAN = Plan(kills=200, inspections=80, analyses=16, solves=4, pause=(0.5, 6.0), deadline=4 * 3600.0)
LATER_STARTS = 3


@measurement(issue=6, line=1)
def start_of_the_service() -> Iterator[Row]:
    service = Service(PORT)
    seconds: list[float] = []
    processor: list[float] = []
    others = os.getloadavg()[0]
    for _ in range(1 + LATER_STARTS):
        begin = time.perf_counter()
        service.start()
        _wait_until_ready()
        seconds.append(time.perf_counter() - begin)
        processor.append(_processor_seconds(service))
        service.stop()
    service.remove()
    yield Row(quantity="start on an empty folder", value=seconds[0], limit="<= 15", unit="s", subject="gaitlab serve")
    later = median(seconds[1:])
    yield Row(quantity="later start, median of 3", value=later, limit="<= 5", unit="s", subject="gaitlab serve")
    spent = median(processor[1:])
    yield Row(quantity="processor time of a later start", value=spent, limit="", unit="s", subject="gaitlab serve")
    yield Row(quantity="load average of the machine before", value=others, limit="", unit="", subject="gaitlab serve")


def _processor_seconds(service: Service) -> float:
    """Of the service and what it started, but of those that still load for later, too."""
    root = psutil.Process(service.process.pid)
    return sum(sum(each.cpu_times()[:4]) for each in [root, *root.children(recursive=True)])


@measurement(issue=6, line=1)
def kills_at_random() -> Iterator[Row]:
    report, subject = kill_at_random(demo_files(), PLAN), f"{PLAN.jobs} jobs"
    for kind, count in sorted(report.kills.items()):
        yield Row(quantity=f"kill -9 of {kind}", value=count, limit="", unit="", subject=subject)
    yield Row(quantity="kills", value=report.kills.total(), limit=">= 200", unit="", subject=subject)
    analyses = PLAN.analyses + PLAN.solves
    yield Row(quantity="analyses among them", value=analyses, limit=">= 20", unit="", subject=subject)
    yield Row(quantity="analyses with weights", value=PLAN.solves, limit="", unit="", subject=subject)
    yield Row(quantity="begun again", value=report.interrupted, limit=">= 1", unit="", subject=subject)
    lost = PLAN.jobs - report.statuses["succeeded"]
    for quantity, value in (("lost", lost), ("done twice", report.twice), ("damaged uploads", report.damaged)):
        yield Row(quantity=quantity, value=value, limit="<= 0", unit="", subject=subject)
    yield Row(quantity="time of all", value=report.seconds, limit="", unit="s", subject=subject)


def _wait_until_ready() -> None:
    while True:
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{PORT}/health/ready", timeout=5.0):
                return
        except (urllib.error.URLError, OSError):
            time.sleep(0.05)
