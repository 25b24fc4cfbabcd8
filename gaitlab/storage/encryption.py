"""Encryption of stored files and secrets with a key from a file: AES-256-GCM, files in chunks.

Each file has a key of its own, derived from the installation's key and a random salt (HKDF-SHA256), and each chunk a
nonce made of its number and a mark of the last one, so that chunks can be neither swapped, dropped nor appended
(the STREAM construction: Hoang, Reyhanitabar, Rogaway, Vizár, Crypto 2015).
"""

import hmac
import os
import secrets
from collections.abc import Iterable, Iterator
from hashlib import sha256
from pathlib import Path

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import AESGCM
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.kdf.hkdf import HKDF

from ..errors import StorageError

MAGIC = b"GLAB\x01"
SALT_BYTES = KEY_BYTES = 32
CHUNK = 1 << 20
"""Plain bytes of each chunk but the last."""
TAG = 16


class FileKey:
    """The installation's key."""

    def __init__(self, key: bytes) -> None:
        if len(key) != KEY_BYTES:
            raise StorageError(f"a key has {KEY_BYTES} bytes, this one {len(key)}: make one with gaitlab key")
        self._key = key

    @classmethod
    def load(cls, path: Path) -> "FileKey":
        """Read a key file, 64 hexadecimal digits, which nobody else may read."""
        try:
            mode, text = path.stat().st_mode, path.read_text(encoding="ascii")
            key = bytes.fromhex(text.strip())
        except OSError as error:
            raise StorageError(f"{path}: the key cannot be read ({error.strerror})") from error
        except ValueError as error:
            raise StorageError(f"{path} holds no key of {2 * KEY_BYTES} hexadecimal digits") from error
        if mode & 0o077:
            raise StorageError(f"{path} can be read by others: chmod 600 {path}")
        return cls(key)

    @staticmethod
    def make() -> bytes:
        """Content of a new key file."""
        return secrets.token_hex(KEY_BYTES).encode() + b"\n"

    def object_name(self, digest: str) -> str:
        """Name to store a content under, so that names do not tell whether a known file is there."""
        return hmac.new(self._key, f"name {digest}".encode(), sha256).hexdigest()

    def encrypt(self, chunks: Iterable[bytes]) -> Iterator[bytes]:
        """The stored form of a content."""
        salt = os.urandom(SALT_BYTES)
        yield MAGIC + salt
        cipher = self._cipher(salt)
        for number, (block, last) in enumerate(_with_last(_blocks(chunks, CHUNK))):
            yield cipher.encrypt(_nonce(number, last), block, None)

    def decrypt(self, chunks: Iterable[bytes]) -> Iterator[bytes]:
        """The content of a stored form.

        Raises:
            StorageError: It is not encrypted, was changed or cut, or has another key.
        """
        head, rest = _split(chunks, len(MAGIC) + SALT_BYTES)
        if not head.startswith(MAGIC):
            raise StorageError("a stored file is not encrypted although there is a key file")
        cipher = self._cipher(head[len(MAGIC) :])
        for number, (block, last) in enumerate(_with_last(_blocks(rest, CHUNK + TAG))):
            try:
                yield cipher.decrypt(_nonce(number, last), block, None)
            except InvalidTag as error:
                raise StorageError("a stored file was changed, or was encrypted with another key") from error

    def seal(self, secret: bytes, owner: bytes) -> bytes:
        """A short secret encrypted; it opens for the same owner only."""
        salt = os.urandom(SALT_BYTES)
        return salt + self._cipher(salt, b"gaitlab secret").encrypt(_nonce(0, True), secret, owner)

    def unseal(self, sealed: bytes, owner: bytes) -> bytes:
        """The secret that was sealed.

        Raises:
            StorageError: It was changed, belongs to another owner, or has another key.
        """
        try:
            cipher = self._cipher(sealed[:SALT_BYTES], b"gaitlab secret")
            return cipher.decrypt(_nonce(0, True), sealed[SALT_BYTES:], owner)
        except InvalidTag as error:
            raise StorageError("a stored secret was changed, or was encrypted with another key") from error

    def _cipher(self, salt: bytes, purpose: bytes = b"gaitlab file") -> AESGCM:
        return AESGCM(HKDF(algorithm=SHA256(), length=KEY_BYTES, salt=salt, info=purpose).derive(self._key))


def _nonce(number: int, last: bool) -> bytes:
    return number.to_bytes(11, "big") + bytes([last])


def _blocks(chunks: Iterable[bytes], size: int) -> Iterator[bytes]:
    """The same bytes in blocks of `size`; the last is shorter, and there is always one."""
    buffer = bytearray()
    for chunk in chunks:
        buffer += chunk
        while len(buffer) > size:
            yield bytes(buffer[:size])
            del buffer[:size]
    yield bytes(buffer)


def _with_last(blocks: Iterator[bytes]) -> Iterator[tuple[bytes, bool]]:
    present = next(blocks)
    for following in blocks:
        yield present, False
        present = following
    yield present, True


def _split(chunks: Iterable[bytes], size: int) -> tuple[bytes, Iterator[bytes]]:
    iterator = iter(chunks)
    head = b""
    for chunk in iterator:
        head += chunk
        if len(head) >= size:
            break
    return head[:size], _chain(head[size:], iterator)


def _chain(first: bytes, rest: Iterator[bytes]) -> Iterator[bytes]:
    yield first
    yield from rest
