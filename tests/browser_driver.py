"""A headless Chromium, for tests and measurements."""

import shutil
from contextlib import contextmanager

WIDTH, HEIGHT = 1280, 900


def chromium_path():
    """The distribution's browser, as playwright's own is not downloaded; None where there is none."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


@contextmanager
def launched(sync_playwright):
    """A browser; `sync_playwright` is the function of that name, as not everybody has the package."""
    with sync_playwright() as driver:
        # Without its sandbox, because continuous integration is root.
        browser = driver.chromium.launch(executable_path=chromium_path(), args=["--no-sandbox", "--use-gl=swiftshader"])
        yield browser
        browser.close()


def new_context(browser, base_url, **more):
    """A browser of its own, without cookies and cache."""
    size = {"width": more.pop("width", WIDTH), "height": HEIGHT}
    return browser.new_context(base_url=str(base_url), viewport=size, locale="en-GB", reduced_motion="reduce", **more)


def sign_in(page, login, password):
    """Type name and password."""
    page.goto("/")
    page.get_by_label("Login").fill(login)
    page.locator("input[type=password]").fill(password)
    page.get_by_role("button", name="Sign in").click()
    page.get_by_role("heading", name="Patients").wait_for()
