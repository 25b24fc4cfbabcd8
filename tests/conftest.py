"""Fixtures that every test may use, and the rule that tests on real recordings are not skipped silently."""

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
SHARED_DATA = ROOT.parent / "shared" / "data"
REQUIRED = "GAITLAB_REQUIRE_SHARED_DATA"


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of the real recordings; skips where it is absent, fails there if it is required."""
    if not SHARED_DATA.is_dir():
        give_up = pytest.fail if os.environ.get(REQUIRED) else pytest.skip
        give_up(f"needs the real recordings in {SHARED_DATA}")
    return SHARED_DATA


@pytest.hookimpl(tryfirst=True)
def pytest_sessionfinish(session, exitstatus):
    """With GAITLAB_REQUIRE_SHARED_DATA=1 a skipped test on real recordings fails the run."""
    del exitstatus  # Unused.
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if not os.environ.get(REQUIRED) or reporter is None:
        return
    skipped = [report.nodeid for report in reporter.stats.get("skipped", []) if "shared_data" in report.keywords]
    if skipped:
        reporter.write_line(f"{REQUIRED} is set, but these tests were skipped: {', '.join(skipped)}", red=True)
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
