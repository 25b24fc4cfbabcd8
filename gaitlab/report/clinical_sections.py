"""Sections of the clinical part: who and what, kinematics page, spatiotemporal table, events."""

from collections.abc import Mapping, Sequence

from ..clinical.document import CURVES, SIDES
from .blocks import Block, Section, Table, facts, missing, paragraph, picture, section, table
from .cycle_panels import Marks
from .formatting import ABSENT, fixed, label, plain, unit_of
from .kinematics_figure import average_figure
from .result import Result, first_real, mapping, real, sequence
from .score_sections import norms_of

_CONVENTIONS = (
    "Conventions: angles in degrees; pelvic tilt anterior +, obliquity up +, rotation internal +; hip flexion +, "
    "adduction +, internal rotation +; knee flexion +; ankle dorsiflexion +; foot progression internal +. Left "
    "is drawn solid, right dashed."
)

_FORWARD = {
    "laboratory axis": "the laboratory axis next to the walking direction, as in Plug-in Gait",
    "heading": "the walking direction",
}
_DISTANCES = (
    "Cycle: foot strike to next foot strike of the same side; mean ± standard deviation over the cycles. Stride "
    "length: way of the heel marker on the floor, and its direction is that of progression; step length and step time "
    "belong to the foot that lands; step width: distance of the opposite foot's strike from the line through the own "
    "two. Double support is the sum of both phases of a cycle."
)


def subject_section(result: Result) -> Section:
    """Subject and input files with their fingerprints."""
    members = result.part("subject")
    known = {key: value for key, value in members.items() if key not in {"segments", "assumed", "parameters"}}
    subject = facts(known, "Subject") if known else missing("subject", "result.json says nothing about it")
    assumed = ", ".join(str(name).replace("_", " ") for name in sequence(members.get("assumed")))
    estimated = paragraph(f"Estimated, neither measured nor given: {assumed}.", "alert") if assumed else None
    return section("Subject and inputs", subject, estimated, _inputs(result))


def body_section(result: Result) -> Section:
    """Body parameters and the segments of the model."""
    members = result.part("subject")
    tables = [found for found in (_parameters(members), _segments(members)) if found is not None]
    return section("Body", *(tables or [missing("body parameters", "result.json holds none")]))


def _parameters(subject: Mapping[str, object]) -> Table | None:
    """Body parameters, left beside right; mass and height stand above."""
    values = {key: value for key, value in mapping(subject.get("parameters")).items() if key not in {"mass", "height"}}
    sided = {key.removeprefix(f"{side}_") for key in values for side in SIDES if key.startswith(f"{side}_")}
    rows = [(label(name), *(plain(values.get(f"{side}_{name}")) for side in SIDES), "") for name in sorted(sided)]
    rows += [(label(name), "", "", plain(values[name])) for name in sorted(values) if name.split("_")[0] not in SIDES]
    caption = "Body parameters (lengths in m, angles in rad)"
    return table(("", "left", "right", "body"), rows, caption, "sides") if rows else None


def _segments(subject: Mapping[str, object]) -> Table | None:
    segments = [mapping(item) for item in sequence(subject.get("segments"))]
    rows = [
        (
            str(s.get("name") or "unnamed").replace("_", " "),
            fixed(real(s.get("mass_kg")), 2),
            fixed(real(s.get("length_m")), 3),
        )
        for s in segments
    ]
    return table(("segment", "mass [kg]", "length [m]"), rows, "Segments of the model") if rows else None


def _inputs(result: Result) -> Block:
    files = [mapping(item) for item in result.parts("inputs")]
    if not files:
        return missing("input files", "result.json lists none")
    keys = list(dict.fromkeys(key for file in files for key in file if key not in {"name", "file", "path", "sha256"}))
    rows = [
        (
            str(file.get("name") or file.get("file") or file.get("path") or "unnamed"),
            *(plain(file.get(key)) for key in keys),
            str(file.get("sha256") or ABSENT),
        )
        for file in files
    ]
    return table(("File", *(label(key) for key in keys), "sha256"), rows, "Input files", "inputs")


def marks_of(result: Result) -> dict[str, Marks]:
    """Foot off and the opposite foot's events of each side [%], from the spatiotemporal table."""
    sides = result.part("spatiotemporal")
    return {side: _marks(mapping(sides.get(side))) for side in SIDES if mapping(sides.get(side))}


def _marks(side: Mapping[str, object]) -> Marks:
    values = mapping(side.get("mean")) or side
    return Marks(
        foot_off=first_real(values, ("foot_off_percent", "stance_percent")),
        opposite_foot_off=first_real(values, ("opposite_foot_off_percent",)),
        opposite_foot_strike=first_real(values, ("opposite_foot_strike_percent",)),
    )


def kinematics_section(result: Result, beside: Sequence[Block] = ()) -> Section:
    """Average page: mean and standard deviation of each curve over the cycles; `beside` stands below the curves."""
    if not any(result.kinematics.get(name) for name in CURVES):
        why = "no side has a complete cycle with all markers" if result.kinematics else "result.json holds none"
        return section("Kinematics", missing("joint angles over the gait cycle", why))
    absent = [
        f"{name.replace('_', ' ')} ({side})"
        for name in CURVES
        for side in SIDES
        if side not in result.kinematics.get(name, {})
    ]
    gap = missing(", ".join(absent), "result.json has no complete cycle of them") if absent else None
    average = average_figure(result.kinematics, marks_of(result), norms_of(result))
    lead = paragraph(_cycles_used(result), "lead")
    conventions = paragraph(f"{_CONVENTIONS} {_forward(result)}", "note")
    return section("Kinematics", lead, picture(average), conventions, *beside, gap)


def _forward(result: Result) -> str:
    """What rotations about the vertical are measured against."""
    stated = result.part("settings").get("forward")
    words = _FORWARD.get(str(stated), "a direction that the result does not state")
    return f"Pelvis rotation and foot progression are measured against {words}."


def _cycles_used(result: Result) -> str:
    counts = {
        side: max(
            (c.n_cycles for curves in result.kinematics.values() if (c := curves.get(side)) and c.n_cycles),
            default=None,
        )
        for side in SIDES
    }
    parts = [f"{side} {count}" for side, count in counts.items() if count is not None]
    return f"Number of cycles: {', '.join(parts)}." if parts else "Number of cycles: not stated."


def spatiotemporal_section(result: Result) -> Section:
    """Table of distances and times, left and right, with standard deviations where there are two cycles or more."""
    title = "Spatiotemporal parameters"
    cells = spatiotemporal_cells(result)
    if not cells:
        return section(title, missing("spatiotemporal parameters", "no side has a complete cycle"))
    reference = mapping(mapping(result.part("scores").get("reference")).get("spatiotemporal"))
    sides = {side: mapping(result.part("spatiotemporal").get(side)) for side in SIDES}
    columns = 3 if reference else 2
    rows = [(label(key), *values[:columns]) for key, values in cells.items()]
    counts = [plain(sides[side].get("n_cycles")) for side in SIDES]
    rows.append(("Cycles", *(*counts, "")[:columns]))
    words = f"Reference: {norms_of(result).description}; distances for this person's leg length."
    norm = paragraph(words if reference else "No normative column: no reference cohort applies.", "note")
    header = ("", "left", "right", "reference")[: columns + 1]
    conventions = paragraph(_DISTANCES, "note")
    return section(title, table(header, rows, kind="sides"), norm, conventions, _dimensionless(sides))


def spatiotemporal_cells(result: Result) -> dict[str, tuple[str, str, str]]:
    """Left, right and reference of each distance and time, as printed."""
    sides = {side: mapping(result.part("spatiotemporal").get(side)) for side in SIDES}
    means = {side: mapping(values.get("mean")) or values for side, values in sides.items()}
    keys = list(dict.fromkeys(key for values in means.values() for key in values if real(values[key]) is not None))
    reference = mapping(mapping(result.part("scores").get("reference")).get("spatiotemporal"))
    found = dict[str, tuple[str, str, str]]()
    for key in (key for key in keys if key != "n_cycles"):
        left, right = (_with_sd(key, means[side], mapping(sides[side].get("sd"))) for side in SIDES)
        found[key] = (left, right, _reference(key, mapping(reference.get(key))))
    return found


def _dimensionless(sides: Mapping[str, Mapping[str, object]]) -> Table | None:
    values = {side: mapping(members.get("normalised")) for side, members in sides.items()}
    keys = list(dict.fromkeys(key for found in values.values() for key in found if real(found[key]) is not None))
    rows = [(label(key), *(fixed(real(values[side].get(key)), 3) for side in SIDES)) for key in keys]
    caption = "Dimensionless with leg length l: v / sqrt(g l), f / sqrt(g / l), x / l, t / sqrt(l / g)"
    return table(("", "left", "right"), rows, caption, "sides") if rows else None


def _reference(key: str, value: Mapping[str, object]) -> str:
    return _with_sd(key, {key: value.get("mean")}, {key: value.get("sd")}) if value else ABSENT


def _with_sd(key: str, means: Mapping[str, object], deviations: Mapping[str, object]) -> str:
    value, sd = real(means.get(key)), real(deviations.get(key))
    if value is None:
        return ABSENT
    decimals = {"%": 1, "steps/min": 1, "m/s": 2}.get(unit_of(key), 3)
    return fixed(value, decimals) + (f" ± {fixed(sd, decimals)}" if sd is not None else "")


def events_section(result: Result) -> Section:
    """Tables of the gait events and where they come from, one per trial: each has a clock of its own."""
    if not result.events:
        return section("Gait events", missing("gait events", "result.json lists none"))
    trials = dict[str, list[tuple[float, str, str, str]]]()
    for event in map(mapping, result.parts("events")):
        time = real(event.get("time_s"))
        if time is not None:
            words = (str(event.get("side")), str(event.get("kind")).replace("_", " "), str(event.get("source")))
            trials.setdefault(str(event.get("trial") or ""), []).append((time, *words))
    header = ("time [s]", "side", "event", "source")
    tables = [
        table(
            header,
            [(f"{time:.3f}", *words) for time, *words in sorted(rows)],
            f"{name}: times from the first stored frame" if len(trials) > 1 else "Times from the first stored frame",
            "narrow",
        )
        for name, rows in trials.items()
    ]
    return section("Gait events", *tables)
