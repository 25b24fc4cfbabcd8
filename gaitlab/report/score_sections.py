"""Sections of judgement: scores against the reference cohort, outlier strides and consistency."""

from collections.abc import Mapping

from ..clinical.document import CURVES, SIDES
from ..clinical.gait_profile import GPS_MINIMAL_DIFFERENCE, VARIABLES
from .blocks import Block, Section, Table, bullets, missing, paragraph, picture, section, table
from .formatting import ABSENT, fixed
from .kinematics_figure import NO_NORMS, Norms
from .profile_figure import profile_figure
from .result import Result, curve_of, mapping, real, sequence


def norms_of(result: Result) -> Norms:
    """The reference cohort that the document was compared with: angles, kinetics and EMG by their names."""
    reference = mapping(result.part("scores").get("reference"))
    if not reference:
        return NO_NORMS
    bands = {
        name: value for key in ("curves", "kinetics", "emg") for name, value in mapping(reference.get(key)).items()
    }
    curves = {name: curve for name, value in bands.items() if (curve := curve_of(value))}
    return Norms(description=str(reference.get("description") or "source not stated"), curves=curves)


def scores_sections(result: Result) -> tuple[Section, ...]:
    """Movement analysis profile, gait profile score, gait deviation index, and what is missing."""
    scores = result.part("scores")
    if not scores:
        return (section("Scores", missing("scores", "result.json holds none")),)
    absent = [str(sentence) for sentence in sequence(scores.get("missing"))]
    notes = bullets(absent, "missing") if absent else None
    sides = {side: mapping(scores.get(side)) for side in SIDES}
    if not any(sides.values()):
        return (section("Scores", missing("scores", "nothing to compare with"), notes),)
    reference = mapping(scores.get("reference"))
    profiles = {side: _numbers(mapping(values.get("gvs"))) for side, values in sides.items()}
    totals = {side: real(values.get("gps")) for side, values in sides.items()}
    overall = real(scores.get("gps_overall"))
    drawn = profile_figure(profiles, {**totals, "overall": overall}, _cohort_scores(reference))
    words = paragraph(
        "Gait variable score (GVS): root mean square difference of the mean curve from the reference mean over the "
        "cycle. Gait profile score (GPS): root mean square over the nine of a side; overall over 15, the pelvis once, "
        f"from the left (Baker 2009). Minimal clinically important difference of the GPS: {GPS_MINIMAL_DIFFERENCE:g} "
        "deg (Baker 2012).",
        "note",
    )
    source = f"Reference: {reference.get('description')}. {reference.get('source')}." if reference else ""
    licence = f" Licence: {reference.get('licence')}" if reference else ""
    named = paragraph(source + licence, "note") if source else None
    return (section("Scores", picture(drawn), _table(sides, overall), words, named, notes),)


def _numbers(values: Mapping[str, object]) -> dict[str, float]:
    return {name: number for name, value in values.items() if (number := real(value)) is not None}


def _cohort_scores(reference: Mapping[str, object]) -> dict[str, float]:
    """Mean scores of the cohort's own persons [deg], where they are known."""
    scores = {name: mapping(value).get("mean") for name, value in mapping(reference.get("gvs")).items()}
    return _numbers({**scores, "gps": mapping(reference.get("gps")).get("mean")})


def _table(sides: Mapping[str, Mapping[str, object]], overall: float | None) -> Table:
    rows = [
        (
            f"GVS {name.replace('_', ' ')} [deg]",
            *(fixed(real(mapping(v.get("gvs")).get(name)), 1) for v in sides.values()),
        )
        for name in VARIABLES
    ]
    rows.append(("GPS [deg]", *(_with_sd(values) for values in sides.values())))
    rows.append(("GPS overall [deg]", fixed(overall, 1), ""))
    rows.append(("GDI", *(fixed(real(values.get("gdi")), 0) for values in sides.values())))
    rows.append(("Cycles", *(str(values.get("n_cycles") or ABSENT) for values in sides.values())))
    return table(("", "left", "right"), rows, "Scores (± standard deviation between cycles)", "sides")


def _with_sd(values: Mapping[str, object]) -> str:
    gps, sd = real(values.get("gps")), real(values.get("gps_sd"))
    return fixed(gps, 1) + (f" ± {fixed(sd, 1)}" if sd is not None and gps is not None else "")


def strides_section(result: Result) -> Section:
    """Consistency of the curves, and the strides that differ."""
    title = "Strides and consistency"
    members = result.part("strides")
    strides = [mapping(item) for item in sequence(members.get("strides"))]
    if not strides:
        return section(title, missing("strides", "result.json lists none"))
    flagged = [stride for stride in strides if sequence(stride.get("outlier"))]
    chosen = [_stride(stride) for stride in strides if stride.get("representative") is True]
    lines = [
        f"{_stride(stride)}: {'; '.join(str(why) for why in sequence(stride.get('outlier')))}" for stride in flagged
    ]
    parts = [
        paragraph(f"Representative strides (closest to the median stride): {', '.join(chosen) or 'none is complete'}."),
        paragraph(f"Strides that differ from the others: {len(flagged)} of {len(strides)}.", "lead"),
        bullets(lines, "alert") if lines else None,
        _consistency(mapping(members.get("consistency"))),
        paragraph(str(members.get("rule") or ""), "note"),
    ]
    return section(title, *parts)


def _stride(stride: Mapping[str, object]) -> str:
    start, end = real(stride.get("start_s")), real(stride.get("end_s"))
    span = "" if start is None or end is None else f" {start:.2f}–{end:.2f} s"
    return f"{stride.get('trial')} {stride.get('side')}{span}"


def _consistency(values: Mapping[str, object]) -> Block:
    if not values:
        return missing("consistency", "no side has two complete strides")
    rows = [
        (
            name.replace("_", " "),
            *(fixed(real(_entry(values, name, side).get(key)), digits) for key, digits in _SHOWN for side in SIDES),
        )
        for name in CURVES
    ]
    header = ("", *(f"{words} {side}" for words in ("SD [deg]", "CMC") for side in SIDES))
    caption = (
        "SD: between strides, rms over the cycle. CMC: coefficient of multiple correlation (Kadaba 1989); – where "
        "strides differ by as much as the curve moves"
    )
    return table(header, rows, caption)


_SHOWN = (("sd_deg", 1), ("cmc", 3))


def _entry(values: Mapping[str, object], name: str, side: str) -> Mapping[str, object]:
    return mapping(mapping(values.get(name)).get(side))
