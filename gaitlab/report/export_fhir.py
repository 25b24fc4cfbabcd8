"""Export to FHIR R4: a bundle of Observations, one per number or curve. No name and no birth date are in it.

Codes: LOINC for body weight and height; everything else has codes of gaitlab's own system, because no LOINC code for
gait curves, for spatiotemporal parameters of one side or for profile scores was found. Units are UCUM.
Source: HL7 FHIR R4 (4.0.1), resources Bundle and Observation.
"""

import uuid
from dataclasses import dataclass
from pathlib import Path

import msgspec

from ..clinical.document import Document, read_document
from ..clinical.examination import read_examination
from ..errors import OutputError
from .fhir_items import CODES, Item, Json, items
from .ledger import read_ledger
from .source import EXAMINATION

SUBJECTS = "urn:gaitlab:subjects"
NAMESPACE = uuid.uuid5(uuid.NAMESPACE_URL, CODES)
"""Identifiers are made from it and the input files, so the same result always gets the same."""
STATES = {"draft": "preliminary", "signed": "final", "amended": "amended"}
"""States of a report to those of an Observation."""
_CATEGORY = {
    "coding": [{"system": "http://terminology.hl7.org/CodeSystem/observation-category", "code": "procedure"}],
    "text": "clinical gait analysis",
}


@dataclass(frozen=True, kw_only=True)
class Header:
    """What all observations of a bundle share."""

    seed: str
    """Fingerprints of the input files."""
    status: str
    """Of the report: preliminary, final or amended."""
    version: str
    pseudonym: str = ""
    date: str = ""
    """Of the session, ISO 8601."""


def export_fhir(directory: Path, target: Path) -> None:
    """Writes the bundle of a result folder; report.json gives the status, examination.json pseudonym and date.

    Raises:
        InvalidRecording: result.json is absent or does not keep to the contract.
        InvalidSubject: examination.json is broken.
        OutputError: The file cannot be written.
    """
    document = read_document(directory / "result.json")
    bundle = fhir_bundle(document, header_of(document, directory))
    try:
        target.write_bytes(msgspec.json.format(msgspec.json.encode(bundle), indent=2) + b"\n")
    except OSError as error:
        raise OutputError(f"{target} cannot be written ({error.strerror}): choose another folder") from error


def header_of(document: Document, directory: Path) -> Header:
    """What the folder says about subject, date and state of the report."""
    path = directory / EXAMINATION
    examination = read_examination(path) if path.is_file() else None
    date = None if examination is None else examination.session.date
    last = read_ledger(directory).last
    status = "preliminary" if last is None else STATES[last.state]
    return Header(
        seed=" ".join(sorted(entry.sha256 for entry in document.inputs)),
        status="amended" if last is not None and status == "final" and last.number > 1 else status,
        version=document.version,
        pseudonym="" if examination is None else examination.patient.pseudonym,
        date="" if date is None else date.isoformat(),
    )


def fhir_bundle(document: Document, header: Header) -> Json:
    """A FHIR R4 Bundle of type collection with every number that the result holds."""
    observations = [_observation(item, header) for item in items(document)]
    entries = [{"fullUrl": f"urn:uuid:{each['id']}", "resource": each} for each in observations]
    bundle = {"resourceType": "Bundle", "id": _identity(header, "bundle"), "type": "collection"}
    return {**bundle, "entry": entries} if entries else bundle


def _identity(header: Header, code: str) -> str:
    return str(uuid.uuid5(NAMESPACE, f"{header.seed} {code}"))


def _observation(item: Item, header: Header) -> Json:
    own = {"system": CODES, "code": item.code, "display": item.words}
    public = [{"system": "http://loinc.org", "code": item.loinc}] if item.loinc else []
    optional = {
        "subject": {"identifier": {"system": SUBJECTS, "value": header.pseudonym}} if header.pseudonym else None,
        "effectiveDateTime": header.date or None,
        "note": [{"text": item.note}] if item.note else None,
        "bodySite": {"text": f"{item.side} leg"} if item.side else None,
        "method": {"text": item.method} if item.method else None,
        "referenceRange": [item.expected] if item.expected else None,
        "component": list(item.components) or None,
    }
    return {
        "resourceType": "Observation",
        "id": _identity(header, item.code),
        "status": header.status if item.settled else "preliminary",
        "category": [_CATEGORY],
        "code": {"coding": [*public, own], "text": item.words},
        "device": {"display": f"gaitlab {header.version}"},
        **item.value,
        **{name: member for name, member in optional.items() if member is not None},
    }
