"""Contents in an S3-compatible server: every step over the network, with signatures."""

import os
import time

import obstore
import psutil
import pytest
from obstore.store import from_url
from s3_server import environment, free_ports, running_s3
from web_world import DEMO, running_world

from gaitlab.cli.doctor import examine
from gaitlab.errors import StorageError
from gaitlab.storage.backup import back_up, restore
from gaitlab.storage.encryption import FileKey
from gaitlab.storage.files import open_store
from gaitlab.storage.models import Role
from gaitlab.storage.references import refer
from gaitlab.storage.settings import Settings

PLACE = "s3://gait/clinic/files"
LARGE = 23_000_017
"""More than the 5 MB after which obstore sends several parts [bytes]."""
MEMORY = 60e6
SIZES = (0, 1, 1 << 20, LARGE)


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    with running_s3(tmp_path_factory.mktemp("s3")) as variables, environment(variables):
        yield variables


@pytest.fixture(params=["clear", "encrypted"])
def settings(server, tmp_path, request):
    """An installation whose files lie in a prefix of their own."""
    key = None
    if request.param == "encrypted":
        key = tmp_path / "key"
        key.write_bytes(FileKey.make())
        key.chmod(0o600)
    return Settings(data_dir=tmp_path, files=f"{PLACE}/{tmp_path.name}", key_file=key)


@pytest.mark.parametrize("size", SIZES)
def test_what_is_put_is_what_is_read(settings, size):
    store, content = open_store(settings), os.urandom(size)
    stored = store.put([content[: size // 2], content[size // 2 :]])
    assert store.read(stored.sha256) == content
    assert store.put([content]) == stored
    assert [name for name, _ in store.names()] == [store.object_name(stored.sha256)]
    store.delete(stored.sha256)
    store.delete(stored.sha256)
    assert not store.exists(stored.sha256) and list(store.names()) == []
    assert list((settings.data_dir / "spool").iterdir()) == []


def test_a_changed_object_is_noticed_on_reading(settings):
    store = open_store(settings)
    stored = store.put([b"walk" * 1000])
    objects, name = from_url(settings.files), store.object_name(stored.sha256)
    content = bytearray(obstore.get(objects, name).bytes().to_bytes())
    assert (b"walkwalk" in content) is (settings.key_file is None)
    content[-1] ^= 1
    obstore.put(objects, name, bytes(content))
    with pytest.raises(StorageError, match="damaged|changed"):
        store.copy_to(stored.sha256, settings.data_dir / "copy")
    assert not (settings.data_dir / "copy").exists()


def test_a_large_content_never_lies_in_memory(settings):
    store, process = open_store(settings), psutil.Process()
    store.put([b"warm"])
    before, most = process.memory_info().rss, 0
    stored = store.put(number.to_bytes(4, "big") * 250_000 for number in range(200))
    for _ in store.open(stored.sha256):
        most = max(most, process.memory_info().rss)
    assert stored.size == 200_000_000 and most - before < MEMORY


def test_a_wrong_key_of_the_store_is_one_sentence(server, tmp_path):
    with environment({"AWS_SECRET_ACCESS_KEY": "wrong"}):
        store = open_store(Settings(data_dir=tmp_path, files=PLACE))
    assert not store.answers()
    with pytest.raises(StorageError, match="the file store does not answer") as refused:
        store.put([b"walk"])
    assert "\n" not in str(refused.value) and server["AWS_SECRET_ACCESS_KEY"] not in str(refused.value)


def test_a_store_that_is_away_is_said_within_seconds(server, tmp_path):
    with environment({"AWS_ENDPOINT": f"http://127.0.0.1:{free_ports(1)[0]}"}):
        store = open_store(Settings(data_dir=tmp_path, files=PLACE))
    begin = time.monotonic()
    with pytest.raises(StorageError, match="the file store does not answer"):
        store.put([b"walk"])
    assert not store.answers() and time.monotonic() - begin < 25.0


def test_the_web_application_keeps_its_files_there(server, tmp_path):
    content = (DEMO / "static.c3d").read_bytes()
    with running_world(tmp_path, files=f"{PLACE}/web") as world:
        clinician = world.as_role(Role.CLINICIAN)
        address = f"/api/v1/sessions/{world.case.session_id}/recordings?name=static.c3d"
        made = world.client.post(address, headers=clinician, content=content).json()
        back = world.client.get(f"/api/v1/recordings/{made['id']}/file", headers=clinician).content
        assert back == content
        assert world.client.get("/health/ready").json()["files"] == "ready"
        names = [name for name, _ in open_store(world.services.settings).names()]
    assert made["sha256"] in names
    assert not (tmp_path / "files").exists()


def test_a_backup_moves_files_from_the_store_to_a_disk(settings, database, empty_database, tmp_path):
    store = open_store(settings)
    with database.transaction() as session:
        stored = store.put([b"walk"])
        refer(session, store, stored)
    back_up(database, store, tmp_path / "backup.tar")
    disk = open_store(Settings(data_dir=tmp_path / "disk"))
    assert restore(empty_database, disk, tmp_path / "backup.tar").files == 1
    assert disk.read(stored.sha256) == b"walk"


def test_the_doctor_tries_the_store(settings, database):
    settings = Settings(**settings.plain() | {"database_url": database.url})
    found = {each.subject: each for each in examine(settings, verify=False)}
    assert found["files"].well and "access" not in found
