"""Issue 7, line 2: what the first page loads, when it can be used, scripting of a cursor move, a long table's tasks."""

import gzip
import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from browser_driver import launched, new_context, sign_in
from busy_pages import add_patients, add_result, many_strides
from playwright.sync_api import sync_playwright
from registry import Row, measurement
from web_world import PASSWORD, World, running_world

from gaitlab.api.pages import FRONTEND
from gaitlab.storage.models import Role

LOADS, MOVES = 5, 200
STRIDES = 10
"""Of each side: 20 cycles in a panel."""
PATIENTS = 1000
WAIT_MS = 60_000
LONG_TASKS = """window.tasks = [];
new PerformanceObserver((list) => window.tasks.push(...list.getEntries().map((each) => each.duration)))
  .observe({ type: "longtask", buffered: true });"""


@contextmanager
def _pages(folder: str) -> Iterator[tuple[World, Any]]:
    """A clinic with the built pages in a process of this machine, and a browser."""
    path = Path(folder) / "data"
    path.mkdir(mode=0o711)
    Path(folder).chmod(0o711)
    with running_world(path, frontend=FRONTEND) as world, launched(sync_playwright) as browser:
        yield world, browser


def _signed_in(world: World, browser: Any) -> Any:
    context = new_context(browser, world.client.base_url)
    context.set_default_timeout(WAIT_MS)
    page = context.new_page()
    sign_in(page, world.people[Role.CLINICIAN].login, PASSWORD)
    return page


@measurement(issue=7, line=2)
def first_load() -> Iterator[Row]:
    with tempfile.TemporaryDirectory(prefix="gaitlab-pages-") as folder, _pages(folder) as (world, browser):
        cookies = _signed_in(world, browser).context.cookies()
        sizes, seconds = 0, list[float]()
        for _ in range(LOADS):
            context = new_context(browser, world.client.base_url)
            context.add_cookies(cookies)
            page = context.new_page()
            scripts: list[bytes] = []
            page.on("response", lambda told, kept=scripts: kept.append(told.body()) if _is_script(told) else None)
            page.goto("/patients", wait_until="commit")
            page.get_by_role("button", name="New patient").wait_for(timeout=WAIT_MS)
            page.locator("table a").first.wait_for(timeout=WAIT_MS)
            seconds.append(page.evaluate("performance.now()") / 1000.0)
            page.wait_for_load_state("networkidle")
            sizes = sum(len(gzip.compress(script)) for script in scripts)
            context.close()
    yield Row(quantity="JavaScript, gzip", value=sizes / 1000.0, limit="<= 400", unit="kB", subject="list of patients")
    subject = f"list of patients, empty cache, median of {LOADS}"
    yield Row(quantity="interactive", value=float(np.median(seconds)), limit="<= 2", unit="s", subject=subject)


def _is_script(response: Any) -> bool:
    return "javascript" in response.headers.get("content-type", "")


@measurement(issue=7, line=2)
def cursor_move() -> Iterator[Row]:
    with tempfile.TemporaryDirectory(prefix="gaitlab-pages-") as folder, _pages(folder) as (world, browser):
        written = many_strides(Path(folder) / "result", STRIDES)
        result = add_result(world, written, world.case.patient_id, world.case.session_id)
        page = _signed_in(world, browser)
        page.goto(f"/results/{result}")
        page.get_by_text("All cycles").click()
        page.get_by_role("img", name="Knee flexion over").locator("canvas").wait_for()
        page.wait_for_timeout(3000)
        panels = page.locator("figure canvas").count()
        box = page.get_by_role("img", name="Pelvic tilt over").locator(".u-over").bounding_box()
        page.evaluate("addEventListener('mousemove', () => (window.moves = (window.moves ?? 0) + 1))")
        client = page.context.new_cdp_session(page)
        client.send("Performance.enable")
        before = _scripting(client)
        for move in range(MOVES):
            page.mouse.move(box["x"] + 5 + (box["width"] - 10) * move / MOVES, box["y"] + 40)
        seen = page.evaluate("window.moves")
        spent = 1000.0 * (_scripting(client) - before) / seen
    subject = f"{panels} panels x {2 * STRIDES} cycles"
    yield Row(quantity="panels", value=panels, limit=">= 18", unit="", subject=subject)
    yield Row(quantity="moves that the page saw", value=seen, limit=f">= {MOVES // 2}", unit="", subject=subject)
    yield Row(quantity="scripting per move", value=spent, limit="<= 8", unit="ms", subject=subject)


def _scripting(client: Any) -> float:
    """Time spent in scripts so far [s]."""
    told = client.send("Performance.getMetrics")["metrics"]
    return next(each["value"] for each in told if each["name"] == "ScriptDuration")


@measurement(issue=7, line=2)
def long_table() -> Iterator[Row]:
    with tempfile.TemporaryDirectory(prefix="gaitlab-pages-") as folder, _pages(folder) as (world, browser):
        written = many_strides(Path(folder) / "result", 1)
        results = add_patients(world, written, PATIENTS)
        page = _signed_in(world, browser)
        page.add_init_script(LONG_TASKS)
        cohort = world.client.post(
            "/api/v1/cohorts",
            headers=world.as_role(Role.CLINICIAN),
            json={"name": "all", "members": [{"result_id": each} for each in results]},
        )
        cohort.raise_for_status()
        page.goto("/compare")
        browser.start_tracing(page=page, categories=["toplevel", "devtools.timeline"])
        page.get_by_label("Saved cohort").select_option(label=f"all ({PATIENTS})")
        page.get_by_role("columnheader", name="Speed").first.wait_for()
        page.wait_for_timeout(2000)
        loading = page.evaluate("window.tasks.splice(0)")
        page.get_by_role("columnheader", name="Speed").first.get_by_role("button").click()
        page.get_by_label("Filter").press_sequentially("speed_m_per_s>0.7 m-00", delay=40)
        page.get_by_label("Filter").fill("")
        page.get_by_role("region", name="Numbers").evaluate("(region) => region.scrollBy(0, 2000)")
        page.get_by_role("button", name="Show more").last.click()
        page.wait_for_timeout(2000)
        using = page.evaluate("window.tasks")
        busiest = _longest_processor_time(browser.stop_tracing())
    subject = f"{PATIENTS} patients: load, sort, filter, scroll, show more"
    yield Row(quantity="longest task, processor time", value=busiest, limit="<= 50", unit="ms", subject=subject)
    # By the clock a task also waits for whatever else this machine computes: to be read beside its load.
    for part, tasks in (("until the table is there", loading), ("in use", using)):
        longest = max(tasks, default=0.0)
        yield Row(quantity=f"longest task by the clock, {part}", value=longest, limit="", unit="ms", subject=subject)
    yield Row(quantity="load of the machine", value=os.getloadavg()[0], limit="", unit="", subject=subject)


def _longest_processor_time(trace: bytes) -> float:
    """Of the tasks of the page's main thread [ms]."""
    events = json.loads(trace)["traceEvents"]
    threads = {
        (each["pid"], each["tid"])
        for each in events
        if each.get("name") == "thread_name" and each["args"].get("name") == "CrRendererMain"
    }
    tasks = [each for each in events if "tdur" in each and (each["pid"], each["tid"]) in threads]
    return max(each["tdur"] for each in tasks if "RunTask" in each["name"]) / 1000.0
