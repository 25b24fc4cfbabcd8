"""Section of a prediction: what was changed, the way there, what it changes, what is assumed."""

from .blocks import Section, bullets, paragraph, section, table
from .formatting import fixed, label, plain
from .result import SOLVED, Result, mapping, real, sequence

SHOWN = ("speed_m_per_s", "step_length_m", "cadence_steps_per_min")
PEAKS = ("hip_extensor", "hip_flexor", "hip_abductor", "knee_extensor", "ankle_plantarflexor")


def prediction_sections(result: Result) -> tuple[Section, ...]:
    """Nothing for a result of an analysis."""
    entry = result.part("prediction")
    if not entry:
        return ()
    units, reached = mapping(entry.get("units")), mapping(entry.get("reached"))
    asked = mapping(entry.get("request"))
    old, new = mapping(entry.get("identified")), mapping(entry.get("predicted"))
    names = [*SHOWN, *(f"{side}_{peak}_peak_nm_per_kg" for peak in PEAKS for side in ("left", "right"))]
    changed = [
        (label(name.replace("_", " ")), plain(asked[name]), plain(reached.get(name)), str(units.get(name, "")))
        for name in asked
    ]
    path = [
        tuple(fixed(real(step.get(key)), 3) for key in ("share", *SHOWN)) + (plain(step.get("kkt_residual")),)
        for step in map(mapping, sequence(entry.get("path")))
    ]
    solved = entry.get("status") == SOLVED
    return (
        section(
            "Prediction",
            None if solved else paragraph(f"Not converged: {entry.get('message')}", "stamp"),
            paragraph(
                f"The walk called model-optimal in this report is the gait predicted from that of "
                f"{entry.get('source')}; the measured walk beside it is the one that was identified."
            ),
            table(("Quantity", "Asked for", "Reached", "Unit"), changed) if changed else paragraph("Nothing changed."),
            table(
                ("", "Identified", "Predicted"),
                [(label(name), fixed(real(old.get(name)), 3), fixed(real(new.get(name)), 3)) for name in names],
                caption="What it changes",
            ),
            table(
                ("Share", "Speed [m/s]", "Step length [m]", "Cadence [steps/min]", "KKT residual"),
                path,
                caption="Continuation path, every step certified",
            ),
            bullets([str(words) for words in sequence(entry.get("assumptions"))]),
            kind="" if solved else "unsolved",
        ),
    )
