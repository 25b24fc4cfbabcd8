"""The commands that run the web application and look after it."""

from pathlib import Path
from typing import Annotated, Any

import typer

from .server_extra import load

DataDir = Annotated[Path | None, typer.Option(help="Folder of database, files and secrets [GAITLAB_DATA_DIR].")]
DatabaseUrl = Annotated[
    str | None,
    typer.Option(help="PostgreSQL 15 to 18, instead of the embedded one; better as GAITLAB_DATABASE_URL."),
]
Files = Annotated[str | None, typer.Option(help="Store of the files: a folder, or s3://bucket/prefix.")]
KeyFile = Annotated[Path | None, typer.Option(help="Key that encrypts files at rest, from gaitlab key.")]


def serve(  # noqa: PLR0913 - one argument per option of the command
    data_dir: DataDir = None,
    host: Annotated[str | None, typer.Option(help="Address to listen on; default 127.0.0.1.")] = None,
    port: Annotated[int | None, typer.Option(help="Port; default 8000, 0 for any.", min=0, max=65535)] = None,
    database_url: DatabaseUrl = None,
    files: Files = None,
    key_file: KeyFile = None,
    worker: Annotated[bool | None, typer.Option(help="Run a worker beside the web server.")] = None,
    concurrency: Annotated[int | None, typer.Option(help="Analyses at a time.", min=1)] = None,
    tls_certificate: Annotated[Path | None, typer.Option(help="Certificate chain, PEM.")] = None,
    tls_key: Annotated[Path | None, typer.Option(help="Private key, PEM.")] = None,
    public_url: Annotated[str | None, typer.Option(help="Address that users type, behind a proxy.")] = None,
    log_format: Annotated[str | None, typer.Option(help="json or text.")] = None,
) -> None:
    """Run the web application, with its database and a worker unless told otherwise, until interrupted."""
    given = {
        "host": host, "port": port, "worker": worker, "concurrency": concurrency, "tls_certificate": tls_certificate,
        "tls_key": tls_key, "public_url": public_url, "log_format": log_format,
    }  # fmt: skip
    load("serving").serve(_installation(data_dir, database_url, files, key_file) | given)


def worker(  # noqa: PLR0913 - one argument per option of the command
    data_dir: DataDir = None,
    database_url: DatabaseUrl = None,
    files: Files = None,
    key_file: KeyFile = None,
    concurrency: Annotated[int | None, typer.Option(help="Analyses at a time.", min=1)] = None,
    metrics_port: Annotated[int | None, typer.Option(help="Port of Prometheus metrics on 127.0.0.1.", min=0)] = None,
    log_format: Annotated[str | None, typer.Option(help="json or text.")] = None,
) -> None:
    """Work on jobs until interrupted; any number of workers, on any number of machines, share one database."""
    given = {"concurrency": concurrency, "metrics_port": metrics_port, "log_format": log_format}
    load("work").work(_installation(data_dir, database_url, files, key_file) | given)


def doctor(
    data_dir: DataDir = None,
    database_url: DatabaseUrl = None,
    files: Files = None,
    key_file: KeyFile = None,
    verify: Annotated[bool, typer.Option(help="Read every stored file and compare its hash; may take long.")] = False,
) -> None:
    """Check database, files, memory and workers of an installation, and say what to do."""
    load("doctor").doctor(_installation(data_dir, database_url, files, key_file), verify)


def backup(
    target: Annotated[Path, typer.Argument(help="File to write, .tar; it holds patients' data in clear.")],
    data_dir: DataDir = None,
    database_url: DatabaseUrl = None,
    files: Files = None,
    key_file: KeyFile = None,
) -> None:
    """Write everything, database and files, into one file; the service may run meanwhile."""
    load("service").back_up_to(_installation(data_dir, database_url, files, key_file), target)


def restore(
    source: Annotated[Path, typer.Argument(help="File from gaitlab backup.")],
    data_dir: DataDir = None,
    database_url: DatabaseUrl = None,
    files: Files = None,
    key_file: KeyFile = None,
) -> None:
    """Bring a new data folder, or a new database, to the state of a backup."""
    load("service").restore_from(_installation(data_dir, database_url, files, key_file), source)


def retention(
    keep: Annotated[
        list[str] | None, typer.Option(help="SUBJECT=DAYS, or SUBJECT=default; may be given several times.")
    ] = None,
    now: Annotated[bool, typer.Option("--now", help="Remove at once what is too old.")] = False,
    data_dir: DataDir = None,
    database_url: DatabaseUrl = None,
    files: Files = None,
    key_file: KeyFile = None,
) -> None:
    """Show, change and apply the rules of how long things are kept; workers apply them once a day."""
    load("upkeep").retention(_installation(data_dir, database_url, files, key_file), keep or (), now)


def export_patient(
    patient: Annotated[str, typer.Argument(help="Pseudonym or identifier.")],
    target: Annotated[Path, typer.Argument(help="File to write, .zip; it holds the patient's name.")],
    data_dir: DataDir = None,
    database_url: DatabaseUrl = None,
    files: Files = None,
    key_file: KeyFile = None,
) -> None:
    """Write everything about one patient, rows and files, into one zip file."""
    load("upkeep").write_patient(_installation(data_dir, database_url, files, key_file), patient, target)


def key(path: Annotated[Path, typer.Argument(help="File to write; keep a copy elsewhere.")]) -> None:
    """Make a key that encrypts files at rest: without it they cannot be read any more."""
    load("service").make_key(path)


def _installation(
    data_dir: Path | None, database_url: str | None, files: str | None, key_file: Path | None
) -> dict[str, Any]:
    """What all commands are told of the installation, by the names of its settings."""
    return {"data_dir": data_dir, "database_url": database_url, "files": files, "key_file": key_file}


SERVER_COMMANDS = (serve, worker, doctor, backup, restore, retention, export_patient, key)
