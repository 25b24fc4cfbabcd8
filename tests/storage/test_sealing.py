import pytest

from gaitlab.errors import StorageError
from gaitlab.storage.encryption import FileKey
from gaitlab.storage.sealing import MARK, Sealing
from gaitlab.storage.settings import Settings

SECRET = "JBSWY3DPEHPK3PXP"
SEALING = Sealing(key=FileKey(bytes(range(32))))


def test_a_sealed_secret_opens_for_its_owner_only():
    sealed = SEALING.seal(SECRET, "jane")
    assert sealed != SEALING.seal(SECRET, "jane") and SECRET not in sealed
    assert SEALING.open(sealed, "jane") == SECRET
    with pytest.raises(StorageError, match="changed"):
        SEALING.open(sealed, "john")


@pytest.mark.parametrize("sealing", [SEALING, Sealing(key=None)])
def test_rows_of_before_there_was_a_key_are_read(sealing):
    assert sealing.open(SECRET, "jane") == SECRET


@pytest.mark.parametrize("key", [None, FileKey(bytes(32))])
def test_without_its_key_a_secret_stays_closed(key):
    with pytest.raises(StorageError, match="key"):
        Sealing(key=key).open(SEALING.seal(SECRET, "jane"), "jane")


@pytest.mark.parametrize("damage", [lambda text: text[:-1], lambda text: MARK, lambda text: text[:-8]])
def test_a_changed_secret_is_said(damage):
    with pytest.raises(StorageError, match="changed"):
        SEALING.open(damage(SEALING.seal(SECRET, "jane")), "jane")


def test_the_key_is_that_of_the_files(tmp_path):
    assert Sealing.of(Settings(data_dir=tmp_path)).key is None
    path = tmp_path / "key"
    path.touch(0o600)
    path.write_bytes(FileKey.make())
    sealed = Sealing.of(Settings(data_dir=tmp_path, key_file=path)).seal(SECRET, "jane")
    assert sealed.startswith(MARK)
