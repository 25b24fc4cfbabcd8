"""Warns when a file's header may name a person. The text itself is neither kept nor shown."""

import re

from gaitlab.mocap.labels import strip_prefix
from gaitlab.mocap.raw import RawRecording

PERSONAL = re.compile(r"BIRTH|DOB$|PATIENT|SURNAME|FIRST_?NAME|LAST_?NAME|FAMILY_?NAME")
_WORDS = re.compile(r"[^\W\d_]{2,}([ ,.'-]+[^\W\d_]+)*")  # letters only: codes such as P01 hold digits


def privacy_warnings(raw: RawRecording) -> tuple[str, ...]:
    """One sentence per place of the header that may hold a person's name or birth date."""
    warnings: list[str] = []
    if any(_WORDS.fullmatch(text) for text in raw.numbered_texts("SUBJECTS", "NAMES")):
        warnings.append("SUBJECTS:NAMES of the file may be a person's name; gaitlab does not keep it")
    if any(_WORDS.fullmatch(strip_prefix(label)[0]) for label in raw.labels):
        warnings.append("the prefix of the marker labels may be a person's name; gaitlab does not keep it")
    for group, members in raw.parameters.items():
        for name, value in members.items():
            filled = any(value) if isinstance(value, tuple) else bool(value.any())
            if filled and PERSONAL.search(name):
                warnings.append(f"{group}:{name} of the file may be personal data; gaitlab does not keep it")
    return tuple(warnings)
