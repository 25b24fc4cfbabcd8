"""The front page."""

from ..clinical.document import SIDES
from ..clinical.examination import Examination
from .blocks import Block, Section, Table, bullets, paragraph, section, table
from .clinical_sections import spatiotemporal_cells
from .examination_sections import NO_EXAMINATION
from .formatting import ABSENT, fixed, label
from .quality_sections import warnings_section
from .result import Result, mapping, real, sequence
from .score_sections import norms_of
from .source import Source
from .wording import CAVEAT, cohort_weights, weights_in_words

_SHOWN = ("speed_m_per_s", "cadence_steps_per_min", "step_length_m", "step_width_m", "foot_off_percent")


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
