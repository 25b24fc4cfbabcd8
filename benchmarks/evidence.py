"""Measure the "Must hold" lines of the issues and write them as CSV: `make evidence`, or `make evidence ONLY=word`.

With words, only measurements whose name holds one of them run, and only their rows are replaced in the CSV.
"""

import csv
import datetime
import platform
import subprocess
import sys
import time
from pathlib import Path

import issue2_kinematics  # noqa: F401 - registers its measurements
import issue2_main_job  # noqa: F401 - registers its measurements
import issue2_recovery  # noqa: F401 - registers its measurements
import issue2_weights  # noqa: F401 - registers its measurements
import issue3_continuation  # noqa: F401 - registers its measurements
import issue3_minimax  # noqa: F401 - registers its measurements
import issue3_mpcc  # noqa: F401 - registers its measurements
import issue3_null_space  # noqa: F401 - registers its measurements
import issue3_ocp  # noqa: F401 - registers its measurements
import issue4_children  # noqa: F401 - registers its measurements
import issue4_gait  # noqa: F401 - registers its measurements
import issue4_peers  # noqa: F401 - registers its measurements
import issue4_prediction  # noqa: F401 - registers its measurements
import issue5_comparison  # noqa: F401 - registers its measurements
import issue5_kinetics  # noqa: F401 - registers its measurements
import issue5_report  # noqa: F401 - registers its measurements
import issue6_jobs  # noqa: F401 - registers its measurements
import issue6_service  # noqa: F401 - registers its measurements
import issue6_uploads  # noqa: F401 - registers its measurements
import issue6_web  # noqa: F401 - registers its measurements
import issue7_pages  # noqa: F401 - registers its measurements
from registry import MEASUREMENTS, ROOT, Measurement, holds

FOLDER = ROOT / "benchmarks" / "evidence"
COLUMNS = ("issue", "line", "measurement", "quantity", "value", "limit", "holds", "unit", "subject")
COLUMNS += ("machine", "commit", "date")


def machine() -> str:
    """Processor, number of cores, Python."""
    model = next(
        (line.split(":", 1)[1].strip() for line in _lines("/proc/cpuinfo") if line.startswith("model name")),
        platform.processor(),
    )
    cores = sum(line.startswith("processor") for line in _lines("/proc/cpuinfo"))
    return f"{model}, {cores} cores, Python {platform.python_version()}"


def commit() -> str:
    """Short hash of HEAD, with + when the tree differs from it."""
    return _git("rev-parse", "--short", "HEAD") + ("+" if _git("status", "--porcelain", "gaitlab") else "")


def run(chosen: Measurement) -> list[dict[str, object]]:
    """Rows of one measurement, ready for the CSV."""
    start = time.perf_counter()
    where = {"machine": machine(), "commit": commit(), "date": datetime.date.today().isoformat()}
    rows: list[dict[str, object]] = []
    for row in chosen.measure():
        kept = holds(row)
        verdict = "" if kept is None else "yes" if kept else "NO"
        print(f"  {row.subject:24s} {row.quantity:44s} {row.value:12.6g} {row.limit:10s} {row.unit:6s} {verdict}")
        rows.append(
            {"issue": chosen.issue, "line": chosen.line, "measurement": chosen.name, "quantity": row.quantity}
            | {"value": f"{row.value:.8g}", "limit": row.limit, "holds": verdict, "unit": row.unit}
            | {"subject": row.subject, **where}
        )
    print(f"  {time.perf_counter() - start:.0f} s")
    return rows


def main(words: list[str]) -> int:
    """Run the chosen measurements, write the CSV of each issue, return 1 if a limit is broken."""
    broken = False
    for chosen in sorted(MEASUREMENTS, key=lambda m: (m.issue, m.line, m.name)):
        if words and not any(word in chosen.name for word in words):
            continue
        print(f"issue {chosen.issue}, line {chosen.line}: {chosen.name}", flush=True)
        rows = run(chosen)
        broken |= any(row["holds"] == "NO" for row in rows)
        _replace(FOLDER / f"issue{chosen.issue}.csv", chosen.name, rows)
    return int(broken)


def _replace(path: Path, name: str, rows: list[dict[str, object]]) -> None:
    path.parent.mkdir(exist_ok=True)
    kept: list[dict[str, object]] = []
    if path.exists():
        with path.open(newline="") as file:
            kept = [dict(row) for row in csv.DictReader(file) if row["measurement"] != name]
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(kept + rows, key=lambda row: (str(row["line"]), str(row["measurement"]))))


def _git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False).stdout.strip()


def _lines(path: str) -> list[str]:
    return Path(path).read_text().splitlines() if Path(path).exists() else []


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
