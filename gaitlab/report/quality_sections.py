"""Sections of trust: warnings, quality of the data, provenance."""

import numpy as np

from .blocks import Block, Section, bullets, facts, missing, paragraph, section, table
from .formatting import fixed
from .result import Result, mapping, real, sequence

TURNING = 15.0
"""Spread of pelvis rotation between strides [deg], rms over the cycle: 2 to 6 in straight walks of two children and an
adult, 38 and more as soon as one child's turns are among them."""


def turning_warning(result: Result) -> str:
    """What averages of strides in different directions are worth; empty for straight walks."""
    curves = [curve for curve in result.kinematics.get("pelvis_rotation", {}).values() if curve.sd is not None]
    spread = max((float(np.sqrt(np.nanmean(np.square(c.sd)))) for c in curves if c.sd is not None), default=0.0)
    if spread <= TURNING:
        return ""
    return (
        f"the strides go in different directions (standard deviation of pelvis rotation {spread:.0f} deg): averages of "
        "pelvis angles and foot progression, and GPS and GDI, mean little; leave the trials that turn out"
    )


def warnings_section(results: list[tuple[str, Result]]) -> Section:
    """All warnings of the overall document, the first, and of its trials, once each, before anything else."""
    turning = turning_warning(results[0][1])
    seen = {turning: ""} if turning else dict[str, str]()
    for name, result in results:
        for warning in result.warnings:
            seen.setdefault(warning, name)
    if not seen:
        return section("Warnings", paragraph("No warnings.", "calm"))
    several = len({name for name, _ in results}) > 1
    items = [
        f"{name}: {words}" if several and name and not words.startswith(name) else words for words, name in seen.items()
    ]
    count = f"{len(items)} warning{'s' if len(items) > 1 else ''}"
    return section(count, bullets(items), kind="warnings")


def quality_sections(result: Result) -> tuple[Section, ...]:
    """Gaps, plates, calibration, residuals, and whatever else the document says about quality."""
    quality = dict(result.part("quality"))
    if not quality:
        return (section("Quality", missing("quality of the data", "result.json says nothing about it")),)
    parts = [
        _gaps(quality.pop("gaps", None)),
        _plates(result),
        *_calibration(quality.pop("calibration", None)),
        *_residuals(quality),
    ]
    rest = {key: value for key, value in quality.items() if value not in (None, {}, [])}
    return (section("Quality", *parts, facts(rest, "Other") if rest else None),)


def _gaps(value: object) -> Block:
    gaps = [mapping(item) for item in sequence(value)]
    if not gaps:
        return paragraph("Gaps in the markers: none.")
    rows = [
        (
            str(gap.get("marker", "unnamed")),
            str(gap.get("trial", "")),
            fixed(real(gap.get("start_s")), 2),
            fixed(real(gap.get("end_s")), 2),
            "filled" if gap.get("filled") is True else "left open, excluded",
        )
        for gap in gaps
    ]
    return table(("marker", "trial", "from [s]", "to [s]", "what was done"), rows, "Gaps in the markers")


def _plates(result: Result) -> Block:
    """How many contacts with force plates were used, and why the others were not; the page on kinetics lists them."""
    contacts = [mapping(item) for item in sequence(result.part("kinetics").get("contacts"))]
    if not contacts:
        return paragraph("Force plates: no contact, so there are no kinetics.")
    refused = [str(c.get("reason") or "no reason stated") for c in contacts if c.get("accepted") is not True]
    why = "; ".join(f"{reason} ({refused.count(reason)})" for reason in dict.fromkeys(refused))
    used = f"Force plates: {len(contacts) - len(refused)} of {len(contacts)} contacts used"
    return paragraph(f"{used}; not used: {why}." if refused else f"{used}.")


def _calibration(value: object) -> list[Block]:
    members = mapping(value)
    if not members:
        return [missing("calibration", "result.json says nothing about it")]
    computed, stored = mapping(members.get("computed")), mapping(members.get("stored"))
    names = list(dict.fromkeys((*computed, *stored)))
    rows = [(n.replace("_", " "), fixed(real(computed.get(n)), 4), fixed(real(stored.get(n)), 4)) for n in names]
    used = paragraph(f"Calibration used: {members.get('used') or 'not stated'}.")
    header = ("static offset [rad]", "computed from the static trial", "stored in the file")
    return [used, *([table(header, rows, "Static offsets")] if rows else [])]


def _residuals(quality: dict[str, object]) -> list[Block]:
    rms = real(quality.pop("marker_residual_rms_m", None))
    each = mapping(quality.pop("marker_residuals_m", None))
    if rms is None and not each:
        return [missing("marker residuals", "no whole-model kinematics in result.json")]
    total = paragraph(f"Whole-model kinematics, marker residual: {_millimetres(rms)} mm rms over all markers.")
    worst = sorted(each.items(), key=lambda item: -(real(item[1]) or 0.0))
    rows = [(name, _millimetres(real(value))) for name, value in worst]
    header = ("marker", "rms [mm]")
    return [total, *([table(header, rows, "Residual per marker, largest first", "narrow")] if rows else [])]


def _millimetres(value: float | None) -> str:
    return fixed(None if value is None else 1000.0 * value, 1)
