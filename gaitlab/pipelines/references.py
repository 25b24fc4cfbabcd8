"""The reference data of an analysis: which norms and which basis, read, or the reason why there are none."""

from dataclasses import dataclass
from pathlib import Path

from ..clinical.gait_deviation_index import DeviationBasis, read_basis
from ..clinical.normative import ReferenceCohort, SpeedChoice, age_problem, read_cohort
from ..errors import InvalidReference, InvalidSubject, NotFound
from .bundled import DATA_FOLDERS

BUNDLED = "schwartz2008"
NONE = "none"
OLDEST = 130.0  # [years]
NO_BASIS = (
    "GDI: not computed, because no published feature basis is loaded (gaitlab norms import-gdi); a basis from other "
    "data would be another score"
)


@dataclass(frozen=True, kw_only=True)
class ReferenceOptions:
    """What the user may choose about references."""

    norms: str = BUNDLED
    """Name of bundled norms, path of a norm file, or `none`."""
    gdi: str = ""
    """Path of an imported basis of the gait deviation index; empty: none."""
    speed: SpeedChoice = "default"
    age: float | None = None
    """Age of the person [years]."""

    def __post_init__(self) -> None:
        if self.age is not None and not 0.0 <= self.age <= OLDEST:
            raise InvalidSubject(f"age is {self.age:g}: give a value from 0 to {OLDEST:g} years")

    def without_paths(self) -> dict[str, str | float | None]:
        """The choices by name; of paths only the file's name, because a folder may be called after a person."""
        files = {"norms": Path(self.norms).name, "gdi": Path(self.gdi).name if self.gdi else ""}
        return {**files, "speed": self.speed, "age": self.age}


@dataclass(frozen=True, kw_only=True)
class References:
    """What could be read, and sentences on what could not."""

    cohort: ReferenceCohort | None
    basis: DeviationBasis | None
    speed: SpeedChoice
    problems: tuple[str, ...]


def bundled_norms(name: str = BUNDLED, data_folders: tuple[Path, ...] = DATA_FOLDERS) -> Path:
    """Path of norms that come with gaitlab.

    Raises:
        NotFound: There are none of that name.
    """
    found = {path.stem: path for data in data_folders for path in data.glob("norms/*.json")}
    if name not in found:
        raise NotFound("norms", name, found)
    return found[name]


def load_references(options: ReferenceOptions) -> References:
    """Read norms and basis; a broken file is no error but a sentence in the result."""
    problems: list[str] = []
    cohort = None
    if options.norms == NONE:
        problems.append("no norms: none were asked for")
    else:
        try:
            cohort = read_cohort(norm_path(options.norms))
        except (InvalidReference, NotFound) as error:
            problems.append(f"no norms: {error}")
    problems += _unknown_age(cohort, options.age)
    unsuitable = "" if cohort is None else age_problem(cohort, options.age)
    if unsuitable:
        cohort, problems = None, [*problems, unsuitable]
    basis = None
    try:
        basis = read_basis(Path(options.gdi)) if options.gdi else None
        problems += [] if options.gdi else [NO_BASIS]
    except InvalidReference as error:
        problems.append(f"GDI: not computed: {error}")
    return References(cohort=cohort, basis=basis, speed=options.speed, problems=tuple(problems))


def _unknown_age(cohort: ReferenceCohort | None, age: float | None) -> list[str]:
    if cohort is None or cohort.age_years is None or age is not None:
        return []
    low, high = cohort.age_years
    held = cohort.age_words or f"{low:g} to {high:g} years"
    return [f"age of the person not given (--age): whether norms of {held} apply is not checked"]


def norm_path(norms: str) -> Path:
    """Path of norms: a file as it is, otherwise bundled norms of that name; raises NotFound."""
    path = Path(norms)
    return path if path.suffix or path.exists() else bundled_norms(norms)
