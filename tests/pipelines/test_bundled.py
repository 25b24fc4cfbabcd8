import pytest

from gaitlab.errors import NotFound
from gaitlab.pipelines.bundled import demo_folder


def test_the_first_folder_that_has_the_child_is_used(tmp_path):
    for place in ("wheel", "checkout"):
        (tmp_path / place / f"child_{place}").mkdir(parents=True)
        (tmp_path / place / f"child_{place}" / "static.c3d").touch()
    folders = (tmp_path / "wheel", tmp_path / "checkout")
    assert demo_folder("child_checkout", folders) == tmp_path / "checkout" / "child_checkout"
    with pytest.raises(NotFound, match="available: child_checkout, child_wheel"):
        demo_folder("nobody", folders)
