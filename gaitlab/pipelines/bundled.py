"""Where the demo recordings lie, in a checkout and in an installed wheel."""

from pathlib import Path

from ..errors import NotFound

PACKAGE = Path(__file__).parent.parent
DATA_FOLDERS = (PACKAGE / "data", PACKAGE.parent / "data")
DEMO_CHILDREN = ("demo_cp_child", "demo_able_bodied_child")


def demo_folder(child: str, data_folders: tuple[Path, ...] = DATA_FOLDERS) -> Path:
    """Folder of one demo child: static.c3d, walk1.c3d, walk2.c3d, truth.json."""
    found = {path.parent.name: path.parent for data in data_folders for path in data.glob("*/static.c3d")}
    if child not in found:
        raise NotFound("demo recording", child, found)
    return found[child]
