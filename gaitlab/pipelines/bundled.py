"""Where the demo recordings lie, in a checkout and in an installed wheel."""

from pathlib import Path

from ..errors import NotFound

PACKAGE = Path(__file__).parent.parent
DEMO_CHILDREN = ("demo_cp_child", "demo_able_bodied_child")


def demo_folder(child: str) -> Path:
    """Folder of one demo child: static.c3d, walk1.c3d, walk2.c3d, truth.json."""
    for data in (PACKAGE / "data", PACKAGE.parent / "data"):
        if (data / child / "static.c3d").exists():
            return data / child
    raise NotFound("demo recording", child, DEMO_CHILDREN)
