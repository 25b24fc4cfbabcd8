"""Short secrets in rows, sealed with the installation's key where there is one, and as they are where there is none."""

from base64 import b64decode, b64encode
from dataclasses import dataclass
from typing import Self

from ..errors import StorageError
from .encryption import FileKey
from .settings import Settings

MARK = "sealed:"
"""How a sealed secret begins; no secret of ours, all in base 32, holds a colon."""


@dataclass(frozen=True, kw_only=True)
class Sealing:
    """Seals secrets for whom they belong to: in another's row they do not open."""

    key: FileKey | None

    @classmethod
    def of(cls, settings: Settings) -> Self:
        """With the key that the settings name."""
        return cls(key=None if settings.key_file is None else FileKey.load(settings.key_file))

    def seal(self, secret: str, owner: object) -> str:
        """What a row holds."""
        if self.key is None:
            return secret
        return MARK + b64encode(self.key.seal(secret.encode(), str(owner).encode())).decode()

    def open(self, stored: str, owner: object) -> str:
        """The secret; rows of before the installation had a key are in clear.

        Raises:
            StorageError: It was changed, belongs to somebody else, or there is no key or another one.
        """
        if not stored.startswith(MARK):
            return stored
        if self.key is None:
            raise StorageError("a secret in the database is encrypted: start gaitlab with its key file")
        try:
            sealed = b64decode(stored.removeprefix(MARK), validate=True)
        except ValueError as error:
            raise StorageError("a stored secret was changed") from error
        return self.key.unseal(sealed, str(owner).encode()).decode()
