"""Settings of an installation."""

from pathlib import Path

from gaitlab.storage.settings import Settings


def test_a_relative_data_folder_means_that_of_the_caller(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    settings = Settings(data_dir=Path("out/serve"))
    assert settings.data_dir == tmp_path / "out" / "serve"
    assert Settings(**settings.plain()).data_dir == settings.data_dir
