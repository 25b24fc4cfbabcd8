"""Sections on forces: kinetics page, plate contacts, EMG."""

from ..clinical.document import SIDES
from .blocks import Section, bullets, missing, paragraph, picture, section, table
from .clinical_sections import marks_of
from .emg_figure import activity_of, emg_figure
from .formatting import ABSENT, fixed
from .kinetics_figure import PANELS, kinetics_figure
from .result import Result, mapping, real, sequence
from .score_sections import norms_of

_CONVENTIONS = (
    "Conventions: moments are internal, per body mass, positive towards the muscles named second on the axis (an "
    "internal extensor moment is an external flexor moment); power is positive when muscles generate it. Left "
    "is drawn solid, right dashed. Only cycles enter whose foot stood on one force plate, alone and wholly."
)


def kinetics_sections(result: Result) -> tuple[Section, ...]:
    """Average moments, powers and ground reactions, the plate contacts, and what is missing and why."""
    part = result.part("kinetics")
    reasons = [str(sentence) for sentence in sequence(part.get("missing"))]
    contacts = _contacts(part.get("contacts"))
    if not any(result.kinetics.get(panel.name) for panel in PANELS):
        why = "; ".join(reasons) or "result.json holds none"
        return (section("Kinetics", missing("moments, powers and ground reactions", why)), *contacts)
    counts = {
        side: max((c[side].n_cycles or 0 for c in result.kinetics.values() if side in c), default=0) for side in SIDES
    }
    lead = (
        "Number of cycles with a valid plate contact: " + ", ".join(f"{side} {n}" for side, n in counts.items()) + "."
    )
    axes = part.get("moments_in") or "axes that are not stated"
    words = (
        f"{_CONVENTIONS} Moments are expressed in {axes}; inertia of {part.get('inertia') or 'unknown source'}. The "
        "forward part of the ground reaction follows the direction that foot progression is measured against; medial "
        "is towards the other foot."
    )
    page = section(
        "Kinetics",
        paragraph(lead, "lead"),
        picture(kinetics_figure(result.kinetics, marks_of(result), norms_of(result))),
        paragraph(words, "note"),
        bullets(reasons, "missing") if reasons else None,
    )
    return (page, *contacts)


def _contacts(value: object) -> tuple[Section, ...]:
    found = [mapping(item) for item in sequence(value)]
    if not found:
        return ()
    rows = [
        (
            str(contact.get("trial") or "unnamed"),
            str(contact.get("plate") or ABSENT),
            f"{fixed(real(contact.get('start_s')), 2)}–{fixed(real(contact.get('end_s')), 2)}",
            str(contact.get("side") or ABSENT),
            "used" if contact.get("accepted") is True else f"not used: {contact.get('reason') or 'no reason stated'}",
        )
        for contact in found
    ]
    header = ("trial", "plate", "time [s]", "foot", "")
    return (section("Contacts with the force plates", table(header, rows, kind="text")),)


def emg_sections(result: Result) -> tuple[Section, ...]:
    """Mean envelopes of all channels, or why there are none."""
    part = result.part("emg")
    if not result.emg:
        why = "the files hold no EMG" if "emg" in result.document else "result.json holds none"
        return (section("EMG", missing("muscle activity", why)),)
    words = (
        f"Linear envelopes ({part.get('filter') or 'filter not stated'}); each in percent of its own maximum, "
        "which the axis gives in the unit of the file, so heights cannot be compared between muscles or sessions. "
        "A channel whose label names no side is drawn over the cycles of both."
    )
    activity = activity_of(result)
    rule = paragraph(f"Activity {activity.rule}.", "note") if activity.rule else None
    drawn = emg_figure(result.emg, marks_of(result), activity, norms_of(result))
    return (section("EMG", picture(drawn), paragraph(words, "note"), rule),)
