"""Everything that an installation may choose, from the environment (GAITLAB_...) or the command line."""

from pathlib import Path
from typing import Any, Literal

from pydantic import Field, SecretStr, field_validator
from pydantic_settings import BaseSettings, SettingsConfigDict

LogFormat = Literal["json", "text"]


def default_data_dir() -> Path:
    """Folder of the database and the files, when none is given."""
    return Path.home() / ".local" / "share" / "gaitlab"


class Settings(BaseSettings):
    """Settings of the web server and of workers. Secrets never show in a repr or a log."""

    model_config = SettingsConfigDict(env_prefix="GAITLAB_", frozen=True, extra="ignore")

    data_dir: Path = Field(default_factory=default_data_dir)
    """Folder of the embedded database, the files and the secrets."""
    database_url: SecretStr | None = None
    """postgresql://user:password@host/name; None: the embedded PostgreSQL in `data_dir`."""
    files: str = ""
    """Store of the files: empty for `data_dir`/files, a folder, or s3://bucket/prefix."""
    key_file: Path | None = None
    """Key that encrypts files at rest, made by `gaitlab key`; None: files are stored as they are."""

    host: str = "127.0.0.1"
    port: int = Field(default=8000, ge=0, le=65535)
    public_url: str = ""
    """Address that users type, when a proxy stands before the server."""
    tls_certificate: Path | None = None
    tls_key: Path | None = None
    trusted_proxies: tuple[str, ...] = ()
    """Addresses whose X-Forwarded headers are believed."""

    max_upload_bytes: int = Field(default=2_000_000_000, gt=0)
    max_recording_bytes: int = Field(default=500_000_000, gt=0)
    upload_hours: float = Field(default=48.0, gt=0)
    """Time until an unfinished upload is forgotten [h]."""
    session_hours: float = Field(default=12.0, gt=0)
    """Longest life of a signed-in browser [h]."""
    session_idle_minutes: float = Field(default=60.0, gt=0)
    oidc_issuer: str = ""
    oidc_client_id: str = ""
    oidc_client_secret: SecretStr | None = None
    oidc_default_role: str = "viewer"
    oidc_name: str = "Single sign-on"
    """Words on the button."""

    viewers: int = Field(default=20, ge=1)
    """3D sessions of all users together."""
    viewers_per_user: int = Field(default=3, ge=1)
    viewer_idle_minutes: float = Field(default=10.0, gt=0)
    """Time after which a 3D session that nobody looks at is closed [min]."""
    metrics_token: SecretStr | None = None
    """Bearer token of /metrics; None: only askers on this machine get them."""

    worker: bool = True
    """Whether `gaitlab serve` starts a worker of its own."""
    concurrency: int = Field(default=1, ge=1)
    """Jobs that one worker runs at a time."""
    job_seconds: float = Field(default=4 * 3600.0, gt=0)
    """Time-out of one job [s]."""
    job_memory: int = Field(default=16_000_000_000, gt=0)
    """Address space of a job's process [bytes]."""
    job_niceness: int = Field(default=10, ge=0, le=19)
    """How far analyses step back behind the web server on the same machine."""
    attempts: int = Field(default=3, ge=1)
    """Times that a job may lose its process or its worker before it counts as failed."""
    heartbeat_seconds: float = Field(default=5.0, gt=0)
    stalled_seconds: float = Field(default=15.0, gt=0)
    """Silence after which another worker takes a job over [s]."""
    log_format: LogFormat = "json"
    metrics_port: int = Field(default=0, ge=0, le=65535)
    """Port of a worker's metrics on the loopback address; 0: none."""

    @field_validator("data_dir")
    @classmethod
    def _from_the_root(cls, path: Path) -> Path:
        # The embedded PostgreSQL has a working folder of its own.
        return path.absolute()

    @property
    def secure_cookies(self) -> bool:
        """Whether browsers reach the service by TLS, so that cookies may be kept to it."""
        return self.public_url.startswith("https://") or self.tls_certificate is not None

    @property
    def secrets_dir(self) -> Path:
        """Folder of what nobody else may read."""
        return self.data_dir / "secrets"

    def plain(self) -> dict[str, Any]:
        """All settings as JSON holds them, secrets included: for our own processes only, through a pipe."""
        revealed = {
            name: value.get_secret_value()
            for name in type(self).model_fields
            if isinstance(value := getattr(self, name), SecretStr)
        }
        return self.model_dump(mode="json") | revealed
