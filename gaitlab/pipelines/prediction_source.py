"""What `gaitlab analyse` leaves for `gaitlab predict`: the identified gait, and the constants of the direct model."""

from dataclasses import dataclass
from pathlib import Path, PurePath

import msgspec

from ..clinical.document import Document, read_document
from ..errors import InvalidRecording, NotFound, OutputError
from ..inverse.conventional_calibration import Calibration
from ..walking.identified_gait import FILE, IdentifiedGait, decode_array, encode_array, read_gait, write_gait

CALIBRATION = "calibration.json"


@dataclass(frozen=True, kw_only=True)
class PredictionSource:
    """The result of one trial, as far as a prediction needs it."""

    name: str
    gait: IdentifiedGait
    calibration: Calibration
    document: Document


def write_source(gait: IdentifiedGait, calibration: Calibration, folder: Path) -> None:
    """Write both files into the folder of a trial."""
    write_gait(gait, folder / FILE)
    path = folder / CALIBRATION
    try:
        path.write_bytes(msgspec.json.format(msgspec.json.encode(calibration, enc_hook=encode_array), indent=2) + b"\n")
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror}): choose a folder you may write to") from error


def read_source(folder: Path, trial: str = "") -> PredictionSource:
    """Read the result of a trial, or of the first of several in a folder, or of the one that is named.

    Raises:
        InvalidRecording: the folder holds no identified gait.
        NotFound: there is no such trial.
    """
    if not folder.is_dir():
        raise InvalidRecording(f"{folder} is not a folder: give the --out folder of gaitlab analyse")
    trials = trials_of(folder)
    if trial and trial not in trials:
        raise NotFound("trial with an identified gait", trial, trials)
    name = trial or next(iter(trials), "")
    chosen = trials.get(name, folder)
    gait, path = read_gait(chosen / FILE), chosen / CALIBRATION
    try:
        calibration = msgspec.json.decode(path.read_bytes(), type=Calibration, dec_hook=decode_array)
    except (OSError, msgspec.MsgspecError) as error:
        raise InvalidRecording(f"{path} cannot be read ({error}): run 'gaitlab analyse' again") from error
    document = read_document(chosen / "result.json")
    return PredictionSource(name=name, gait=gait, calibration=calibration, document=document)


def trials_of(folder: Path) -> dict[str, Path]:
    """Folders with an identified gait by the names of their walks; of one walk it is the folder itself.

    Raises:
        InvalidRecording: the folder's result cannot be read.
    """
    trials = {path.parent.name: path.parent for path in sorted(folder.glob(f"*/{FILE}"))}
    if not (folder / FILE).is_file():
        return trials
    walks = [PurePath(each.name).stem for each in read_document(folder / "result.json").inputs if each.role == "walk"]
    return dict.fromkeys(walks[:1], folder) | trials
