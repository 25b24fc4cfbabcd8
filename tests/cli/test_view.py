from gaitlab.cli import view


def test_the_address_is_printed(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(view, "open_viewer", lambda directory, port, on_open: on_open(f"http://localhost:{port}"))
    view.view(tmp_path, port=8123)
    assert "http://localhost:8123 shows the walk" in capsys.readouterr().out
