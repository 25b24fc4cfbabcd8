"""Where the numbers come from: versions, fingerprints, settings, machine."""

from collections.abc import Mapping

from .blocks import Section, missing, section, table
from .clinical_sections import subject_section
from .formatting import rows_of
from .source import Source


def provenance_sections(source: Source, program: Mapping[str, str]) -> tuple[Section, ...]:
    """Input files, versions and machines, fingerprints of what the report was made from, and all settings.

    Args:
        source: What the report is made from.
        program: Versions and machine that make the report, by name.
    """
    overall = source.overall
    made = {str(key): str(value) for key, value in overall.part("environment").items()}
    versions = [("gaitlab", str(overall.document.get("version") or "not stated"), program.get("gaitlab", ""))]
    names = [name for name in dict.fromkeys((*made, *program)) if name != "gaitlab"]
    versions += [(name, made.get(name, "not stated"), program.get(name, "not stated")) for name in names]
    hashes = sorted(source.hashes.items())
    settings = overall.part("settings")
    return (
        subject_section(overall),
        section("Provenance", table(("", "analysis", "report"), versions, "Versions and machines", "text")),
        section(
            "Files that this report was made from",
            table(("file", "sha256"), hashes, kind="inputs") if hashes else missing("fingerprints", "no file was read"),
        ),
        section("Settings", table(("", "value"), rows_of(settings or {"settings": None}), kind="facts")),
    )
