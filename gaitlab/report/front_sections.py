"""The front page and the page of the clinical examination."""

from collections.abc import Sequence

from ..clinical.document import SIDES
from ..clinical.examination import Examination, JointRange, Spasticity, Strength
from .blocks import Block, Section, Table, bullets, missing, paragraph, section, table
from .clinical_sections import spatiotemporal_cells
from .formatting import ABSENT, fixed, label
from .quality_sections import warnings_section
from .result import Result, mapping, real, sequence
from .score_sections import norms_of
from .source import Source
from .wording import CAVEAT, cohort_weights, weights_in_words

_SHOWN = ("speed_m_per_s", "cadence_steps_per_min", "step_length_m", "step_width_m", "foot_off_percent")
_Entry = JointRange | Strength | Spasticity
NO_EXAMINATION = "no examination file was given (gaitlab report --examination FILE)"


def front_sections(source: Source) -> tuple[Section, ...]:
    """Who, in which condition, from which trials; speed, scores and weights in short; what is missing; warnings."""
    overall = source.overall
    absent = absences(source)
    weights = overall.weights
    said = (
        [paragraph(weights_in_words(weights, cohort_weights(overall))[0]), paragraph(CAVEAT, "caveat")]
        if weights and weights.criteria
        else []
    )
    results = [("", overall), *((trial.result.name, trial.result) for trial in source.trials if source.several)]
    return (
        section("Session", *_stamps(source), table(("", ""), _session_rows(source), kind="facts")),
        section("In short", _short_table(overall), *said),
        section("Not in this report", bullets(absent, "missing") if absent else paragraph("Nothing is missing.")),
        warnings_section(results),
    )


def _stamps(source: Source) -> list[Block]:
    """Results whose weights carry no certificate, once each."""
    results = {result.name: result.weights for result in (source.overall, *(trial.result for trial in source.trials))}
    unsolved = [name for name, weights in results.items() if weights is not None and not weights.converged]
    return [
        paragraph(f"NOT CONVERGED: the weights of {name} carry no certificate and are marked below.", "stamp")
        for name in unsolved
    ]


def _session_rows(source: Source) -> list[tuple[str, str]]:
    overall = source.overall
    examined = source.examination or Examination()
    condition = [
        f"{words}: {value}"
        for words, value in (
            ("footwear", examined.condition.footwear),
            ("orthosis", examined.condition.orthosis),
            ("walking aid", examined.condition.walking_aid),
        )
        if value
    ]
    subject = overall.part("subject")
    height = real(subject.get("height_m"))
    body = [f"{fixed(overall.mass, 1)} kg"] if overall.mass is not None else []
    body += [] if height is None else [f"{height:.2f} m"]
    age = real(mapping(overall.part("settings").get("references")).get("age"))
    body += [] if age is None else [f"{age:g} years"]
    return [
        ("Patient (pseudonym)", source.name),
        ("Diagnosis", examined.patient.diagnosis or "not stated"),
        ("Body", ", ".join(body) or "not stated"),
        ("Date of the session", str(examined.session.date or "not stated")),
        ("Laboratory", examined.session.laboratory or "not stated"),
        ("Condition", "; ".join(condition) or "not stated"),
        ("Trials", ", ".join(trial.result.name for trial in source.trials)),
        ("Complete cycles", ", ".join(f"{side} {_cycles(overall, side)}" for side in SIDES)),
        ("Reference", norms_of(overall).description or "none applies"),
    ]


def _cycles(result: Result, side: str) -> int:
    curves = [sides[side] for sides in result.kinematics.values() if side in sides]
    return max((curve.n_cycles or 0 for curve in curves), default=0)


def _short_table(result: Result) -> Table:
    """The most asked-for numbers, left, right and reference."""
    cells = spatiotemporal_cells(result)
    rows: list[tuple[str, ...]] = [(label(key), *cells[key]) for key in _SHOWN if key in cells]
    scores = result.part("scores")
    sides = [mapping(scores.get(side)) for side in SIDES]
    reference = mapping(mapping(scores.get("reference")).get("gps"))
    expected = ABSENT if not reference else f"{fixed(real(reference.get('mean')), 1)}"
    rows.append(("Gait profile score [deg]", *(fixed(real(side.get("gps")), 1) for side in sides), expected))
    rows.append(("Gait profile score, overall [deg]", fixed(real(scores.get("gps_overall")), 1), "", expected))
    if any(real(side.get("gdi")) is not None for side in sides):
        rows.append(("Gait deviation index", *(fixed(real(side.get("gdi")), 0) for side in sides), "100"))
    return table(("", "left", "right", "reference"), rows, kind="sides")


def absences(source: Source) -> list[str]:
    """What this report cannot show and why, as sentences."""
    overall = source.overall
    sentences = list[str]()
    for side in SIDES:
        count = _cycles(overall, side)
        if count == 0:
            sentences.append(f"{side} side: no complete cycle with all markers, so its curves and numbers are empty")
        elif count == 1:
            sentences.append(f"{side} side: one cycle only, so there is no standard deviation and no consistency")
    kinetics = [str(sentence) for sentence in sequence(overall.part("kinetics").get("missing"))]
    if not overall.kinetics and not kinetics:
        kinetics = ["kinetics: result.json holds none"]
    scores = [str(sentence) for sentence in sequence(overall.part("scores").get("missing"))]
    sentences += [*kinetics, *scores]
    if overall.weights is None or not overall.weights.criteria:
        sentences.append("weights: they were not asked for, or the computation stopped before them")
    if not overall.emg:
        sentences.append("EMG: the files hold none")
    if source.examination is None:
        sentences.append(f"clinical examination and condition: {NO_EXAMINATION}")
    return sentences


def examination_sections(source: Source) -> tuple[Section, ...]:
    """What the examiner found, in tables of left and right."""
    title = "Clinical examination and condition"
    found = source.examination
    if found is None:
        return (section(title, missing("clinical examination and condition", NO_EXAMINATION)),)
    tables = [*_ranges(found), *_graded(found.strength, "Strength, grade 0 to 5 (MRC)")]
    tables += _graded(found.spasticity, "Spasticity, modified Ashworth scale")
    absent = [
        words
        for words, entries in (
            ("joint ranges", found.ranges),
            ("strength", found.strength),
            ("spasticity", found.spasticity),
        )
        if not entries
    ]
    notes = bullets(found.notes) if found.notes else None
    gap = missing(", ".join(absent), "the examination file holds none") if absent else None
    return (section(title, _condition(found), *tables, notes, gap),)


def _condition(found: Examination) -> Table:
    level = "not stated" if found.patient.gmfcs is None else f"level {'I II III IV V'.split()[found.patient.gmfcs - 1]}"
    rows = [
        ("Diagnosis", found.patient.diagnosis or "not stated"),
        ("GMFCS", level),
        ("Examined by", found.session.examiner or "not stated"),
        ("Footwear", found.condition.footwear or "not stated"),
        ("Orthosis", found.condition.orthosis or "not stated"),
        ("Walking aid", found.condition.walking_aid or "not stated"),
        *([("Remark", found.condition.note)] if found.condition.note else []),
    ]
    return table(("", ""), rows, kind="facts")


def _ranges(found: Examination) -> list[Block]:
    rows = [
        (f"{entry.joint} {entry.motion}", *(ABSENT if v is None else f"{v:g}" for v in (entry.left, entry.right)))
        + _remark(entry, found.ranges)
        for entry in found.ranges
    ]
    return _two_sided(rows, "Passive joint ranges [deg]")


def _graded(entries: Sequence[Strength | Spasticity], caption: str) -> list[Block]:
    rows = [
        (entry.muscle, *(ABSENT if v is None else str(v) for v in (entry.left, entry.right))) + _remark(entry, entries)
        for entry in entries
    ]
    return _two_sided(rows, caption)


def _remark(entry: _Entry, all_of_them: Sequence[_Entry]) -> tuple[str, ...]:
    """A cell of its own where any entry has a remark."""
    return (entry.note,) if any(other.note for other in all_of_them) else ()


def _two_sided(rows: Sequence[tuple[str, ...]], caption: str) -> list[Block]:
    if not rows:
        return []
    header = ("", "left", "right", "remark")[: len(rows[0])]
    return [table(header, rows, caption, "sides")]
