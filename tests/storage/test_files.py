"""Contents on disk, in an object store, in clear and encrypted."""

import os

import pytest
from obstore.store import MemoryStore

from gaitlab.errors import StorageError
from gaitlab.storage.encryption import CHUNK, MAGIC, FileKey
from gaitlab.storage.files import FileStore, open_store
from gaitlab.storage.objects import DiskObjects, RemoteObjects
from gaitlab.storage.settings import Settings

KEY = FileKey(bytes(range(32)))
SIZES = (0, 1, CHUNK, CHUNK + 1, 2 * CHUNK + 17)


@pytest.fixture(params=["disk", "disk encrypted", "remote", "remote encrypted"])
def any_store(request, tmp_path):
    memory = MemoryStore()
    objects = DiskObjects(tmp_path / "files") if "disk" in request.param else RemoteObjects(memory, memory)
    return FileStore(objects, tmp_path, KEY if "encrypted" in request.param else None)


def pieces(content, size=100_003):
    return [content[start : start + size] for start in range(0, len(content), size)]


@pytest.mark.parametrize("size", SIZES)
def test_what_is_put_is_what_is_read(any_store, size):
    content = os.urandom(size)
    stored = any_store.put(pieces(content))
    assert stored.size == size
    assert any_store.read(stored.sha256) == content
    assert any_store.put([content]) == stored


def test_a_content_is_listed_and_deleted(any_store):
    stored = any_store.put([b"walk"])
    assert [name for name, _ in any_store.names()] == [any_store.object_name(stored.sha256)]
    any_store.delete(stored.sha256)
    any_store.delete(stored.sha256)
    assert not any_store.exists(stored.sha256)
    with pytest.raises(StorageError, match="cannot be read"):
        any_store.read(stored.sha256)


@pytest.mark.parametrize("key", [None, KEY], ids=["clear", "encrypted"])
def test_a_changed_byte_is_noticed_on_reading(tmp_path, key):
    store = FileStore(DiskObjects(tmp_path / "files"), tmp_path, key)
    stored = store.put([os.urandom(1000)])
    (path,) = (tmp_path / "files").glob("??/*")
    path.chmod(0o600)
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    target = tmp_path / "copy"
    with pytest.raises(StorageError, match="damaged|changed"):
        store.copy_to(stored.sha256, target)
    assert not target.exists()


@pytest.mark.parametrize("cut", [len(MAGIC) + 32, -1, -(CHUNK + 16)], ids=["all chunks", "a byte", "a whole chunk"])
def test_a_cut_off_end_is_noticed(cut):
    stored = b"".join(KEY.encrypt([bytes(2 * CHUNK)]))
    with pytest.raises(StorageError, match="changed"):
        list(KEY.decrypt([stored[:cut]]))


def test_another_key_and_clear_text_are_refused():
    stored = b"".join(KEY.encrypt([b"walk"]))
    with pytest.raises(StorageError, match="another key"):
        list(FileKey(bytes(32)).decrypt([stored]))
    with pytest.raises(StorageError, match="not encrypted"):
        list(KEY.decrypt([b"walk" * 20]))


def test_encrypted_files_do_not_hold_their_content_or_its_hash(tmp_path):
    store = FileStore(DiskObjects(tmp_path / "files"), tmp_path, KEY)
    stored = store.put([b"Somebody's name" * 100])
    (path,) = (tmp_path / "files").glob("??/*")
    assert b"Somebody" not in path.read_bytes()
    assert path.parent.name + path.name != stored.sha256


def test_the_file_and_its_folder_are_flushed_before_put_returns(tmp_path, monkeypatch):
    flushed = []
    flush = os.fsync
    monkeypatch.setattr(
        os, "fsync", lambda descriptor: (flushed.append(os.readlink(f"/proc/self/fd/{descriptor}")), flush(descriptor))
    )
    objects = DiskObjects(tmp_path / "files")
    stored = FileStore(objects, objects.spool).put([b"walk"])
    assert str(tmp_path / "files" / "spool") in os.path.dirname(flushed[0])
    assert flushed[-1] == str(tmp_path / "files" / stored.sha256[:2])


def test_nothing_is_left_of_a_content_that_breaks_off(tmp_path):
    def broken():
        yield b"half"
        raise ConnectionError

    objects = DiskObjects(tmp_path / "files")
    store = FileStore(objects, objects.spool)
    with pytest.raises(ConnectionError):
        store.put(broken())
    assert list(store.names()) == []
    assert list(objects.spool.iterdir()) == []


def test_a_key_file_must_be_closed_to_others(tmp_path):
    path = tmp_path / "key"
    path.write_bytes(FileKey.make())
    path.chmod(0o644)
    with pytest.raises(StorageError, match="chmod 600"):
        open_store(Settings(data_dir=tmp_path, key_file=path))
    path.chmod(0o600)
    store = open_store(Settings(data_dir=tmp_path, key_file=path))
    assert store.read(store.put([b"walk"]).sha256) == b"walk"


@pytest.mark.parametrize(("text", "problem"), [("zz", "64 hex"), ("00", "32 bytes")])
def test_a_key_file_of_something_else_is_refused(tmp_path, text, problem):
    path = tmp_path / "key"
    path.write_text(text)
    path.chmod(0o600)
    with pytest.raises(StorageError, match=problem):
        FileKey.load(path)
