"""Sections on forces: kinetics page, plate contacts, EMG."""

from ..clinical.document import SIDES
from .clinical_sections import marks_of
from .kinetics_figure import PANELS, emg_figure, kinetics_figure
from .markup import ABSENT, bullets, fixed, missing, paragraph, table, tag
from .result import Result, mapping, real, sequence

_CONVENTIONS = (
    "Conventions: moments are internal, per body mass, positive towards the muscles named second on the axis (an "
    "internal extensor moment is an external flexor moment); power is positive when muscles generate it. Left is red, "
    "right is blue. Only cycles enter whose foot stood on one force plate, alone and wholly."
)


def kinetics_section(result: Result) -> str:
    """Average moments, powers and ground reactions, the plate contacts, and what is missing and why."""
    title = tag("h2", "Kinetics")
    part = result.part("kinetics")
    reasons = [str(sentence) for sentence in sequence(part.get("missing"))]
    contacts = _contacts(part.get("contacts"))
    if not any(result.kinetics.get(panel.name) for panel in PANELS):
        why = "; ".join(reasons) or "result.json holds none"
        return tag("section", title + missing("moments, powers and ground reactions", why) + contacts)
    counts = {
        side: max((c[side].n_cycles or 0 for c in result.kinetics.values() if side in c), default=0) for side in SIDES
    }
    lead = (
        "Number of cycles with a valid plate contact: " + ", ".join(f"{side} {n}" for side, n in counts.items()) + "."
    )
    axes = part.get("moments_in") or "axes that are not stated"
    words = f"{_CONVENTIONS} Moments are expressed in {axes}; inertia of {part.get('inertia') or 'unknown source'}."
    body = (
        paragraph(lead, "lead")
        + kinetics_figure(result.kinetics, marks_of(result))
        + paragraph(words, "note")
        + (bullets(reasons, "missing") if reasons else "")
    )
    return tag("section", title + body, "page") + tag("section", contacts)


def _contacts(value: object) -> str:
    found = [mapping(item) for item in sequence(value)]
    if not found:
        return ""
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
    return table(("trial", "plate", "time [s]", "foot", ""), rows, "Contacts with the force plates")


def emg_section(result: Result) -> str:
    """Mean envelopes of all channels; nothing where the files hold no EMG."""
    part = result.part("emg")
    if not result.emg:
        return ""
    words = (
        f"Linear envelopes ({part.get('filter') or 'filter not stated'}); each in percent of its own maximum, "
        "which the axis gives in the unit of the file, so heights cannot be compared between muscles or sessions. "
        "A channel whose label names no side is drawn over the cycles of both."
    )
    return tag(
        "section", tag("h2", "EMG") + emg_figure(result.emg, marks_of(result)) + paragraph(words, "note"), "page"
    )
