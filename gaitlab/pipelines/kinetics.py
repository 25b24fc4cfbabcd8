"""Kinetics and EMG of one walk, cut into cycles, and their part of the document."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..clinical.cycle_average import average, complete, time_normalise, time_normalise_forces
from ..clinical.document import SIDES
from ..clinical.kinetics_document import (
    UNITS,
    ContactEntry,
    CycleAverage,
    EmgEntry,
    KineticsEntry,
    UnitCurve,
)
from ..clinical.muscle_activity import RULE, Span, active_spans
from ..inverse.conventional import ConventionalKinematics
from ..inverse.leg_kinetics import Kinetics, KineticsSettings, solve_kinetics
from ..mocap.cycle import Cycle
from ..mocap.emg import emg_envelopes, emg_muscle
from ..mocap.plate_assignment import PlateContact, assign_contacts, contact_sentences
from ..mocap.recording import Event, Recording, Side
from ..multibody.subject import SubjectModel
from ..signal.envelope import BAND, SMOOTH

Cycles = Mapping[Side, Sequence[Cycle]]
CycleCurves = Mapping[str, Mapping[Side, tuple[np.ndarray, ...]]]
"""Curve name to side to one array of 101 samples per cycle, NaN where unknown."""

AXES = {
    "distal": "the axes of the segment below the joint",
    "proximal": "the axes of the segment above the joint",
    "joint": "the joint coordinate system (projections)",
    "laboratory": "forward, left and up of the laboratory",
}
INERTIA = {"subject": "the subject's model", "plug-in gait": "Plug-in Gait's published fractions"}
FILTER = f"band-pass {BAND[0]:g}-{BAND[1]:g} Hz, rectified, low-pass {SMOOTH:g} Hz, without phase lag"


@dataclass(frozen=True, kw_only=True)
class TrialKinetics:
    """Forces of one walk."""

    name: str
    kinetics: Kinetics | None
    """None where the file holds no plate."""
    curves: CycleCurves
    """Moments, powers and ground reactions by name; only cycles with a measured ground reaction are whole."""
    emg: CycleCurves
    """Envelopes by label."""
    missing: tuple[str, ...]
    """Why there is nothing, sentences."""
    warnings: tuple[str, ...]
    """About plate contacts that are not used."""
    emg_units: Mapping[str, str] = field(default_factory=dict[str, str])
    """Label to the unit that the file states."""


def trial_kinetics(
    recording: Recording,
    kinematics: ConventionalKinematics,
    subject: SubjectModel,
    steps: tuple[Sequence[Event], Cycles],
    settings: KineticsSettings,
    contacts: Sequence[PlateContact] | None = None,
) -> TrialKinetics:
    """Kinetics and EMG of one walk, per frame and cut into cycles; `steps` are its events and its cycles.

    Which foot stood on which plate is found unless `contacts` tells it.
    """
    events, found = steps
    if contacts is not None:
        solved = solve_kinetics(recording, kinematics, subject, (contacts, events), settings)
        missing, warnings = tuple[str, ...](), tuple[str, ...]()
    else:
        solved, missing, warnings = _solve(recording, kinematics, subject, events, settings)
    curves = {} if solved is None else _cut_curves(solved, found, recording.rate)
    return TrialKinetics(
        name=recording.name,
        kinetics=solved,
        curves=curves,
        emg=_cut_emg(recording, found),
        emg_units=recording.analog_units,
        missing=missing,
        warnings=warnings,
    )


def _solve(
    recording: Recording,
    kinematics: ConventionalKinematics,
    subject: SubjectModel,
    events: Sequence[Event],
    settings: KineticsSettings,
) -> tuple[Kinetics | None, tuple[str, ...], tuple[str, ...]]:
    if not recording.force_plates:
        return None, (f"{recording.name}: no kinetics, the file holds no usable force plate",), ()
    contacts = assign_contacts(recording, events)
    said = contact_sentences(contacts, recording.name)
    missing = tuple(
        f"{recording.name}: no kinetics of the {side} side, its foot has no valid contact with a force plate"
        for side in SIDES
        if not any(contact.accepted and contact.side == side for contact in contacts)
    )
    return solve_kinetics(recording, kinematics, subject, (contacts, events), settings), missing, said


def _cut_curves(solved: Kinetics, found: Cycles, rate: float) -> CycleCurves:
    return {
        name: {
            side: tuple(time_normalise_forces(solved.curves[f"{side}_{name}"], rate, cycle) for cycle in found[side])
            for side in SIDES
        }
        for name in UNITS
    }


def _cut_emg(recording: Recording, found: Cycles) -> CycleCurves:
    return {
        label: {
            side: tuple(time_normalise(envelope.values, envelope.rate, cycle) for cycle in found[side])
            for side in SIDES
            if envelope.side in (None, side)
        }
        for label, envelope in emg_envelopes(recording).items()
    }


def kinetics_entry(trials: Sequence[TrialKinetics]) -> KineticsEntry:
    """Means over the cycles of all trials in which the foot's ground reaction is known, and what is missing and why."""
    solved = [trial.kinetics for trial in trials if trial.kinetics is not None]
    settings = solved[0].settings if solved else KineticsSettings()
    curves = {name: _unit_curve([trial.curves for trial in trials], name, unit) for name, unit in UNITS.items()}
    return KineticsEntry(
        curves={name: curve for name, curve in curves.items() if curve.left or curve.right},
        moments_in=AXES[settings.frame],
        inertia=INERTIA[settings.inertia],
        contacts=[entry for trial in trials for entry in _contacts(trial)],
        missing=[sentence for trial in trials for sentence in trial.missing] + _no_cycle(trials, curves),
    )


def _no_cycle(trials: Sequence[TrialKinetics], curves: Mapping[str, UnitCurve]) -> list[str]:
    """Sides with a valid contact and yet no cycle: the stride was not recorded to its end."""
    sentences: list[str] = []
    for side in SIDES:
        stood = any(
            c.accepted and c.side == side for t in trials if t.kinetics is not None for c in t.kinetics.contacts
        )
        if stood and not any(getattr(curve, side) for curve in curves.values()):
            sentences.append(
                f"no average of the {side} side: no complete stride begins with one of its valid plate contacts"
            )
    return sentences


def emg_entry(trials: Sequence[TrialKinetics]) -> EmgEntry | None:
    """Mean envelopes over all cycles of all trials; None where no file holds EMG."""
    labels = list(dict.fromkeys(label for trial in trials for label in trial.emg))
    if not labels:
        return None
    curves = [trial.emg for trial in trials]
    envelopes = {label: _unit_curve(curves, label, _emg_unit(trials, label)) for label in labels}
    return EmgEntry(
        envelopes=envelopes,
        filter=FILTER,
        activity={label: _activity(curve) for label, curve in envelopes.items()},
        activity_rule=RULE,
        muscles={label: muscle for label in labels if (muscle := emg_muscle(label)) is not None},
    )


def _emg_unit(trials: Sequence[TrialKinetics], label: str) -> str:
    """Unit of a channel where all files that hold it state the same one."""
    units = {trial.emg_units.get(label, "") for trial in trials if label in trial.emg}
    return next(iter(units)) if len(units) == 1 and "" not in units else "file's unit"


def _activity(curve: UnitCurve) -> dict[Side, list[Span]]:
    sides: dict[Side, CycleAverage | None] = {"left": curve.left, "right": curve.right}
    return {side: active_spans(np.array(one.mean, dtype=float)) for side, one in sides.items() if one is not None}


def _unit_curve(curves: Sequence[CycleCurves], name: str, unit: str) -> UnitCurve:
    left, right = (_average(curves, name, side) for side in SIDES)
    return UnitCurve(unit=unit, left=left, right=right)


def _average(curves: Sequence[CycleCurves], name: str, side: Side) -> CycleAverage | None:
    whole = complete([cycle for trial in curves for cycle in trial.get(name, {}).get(side, ())])
    if not whole:
        return None
    mean, deviation = average(whole)
    return CycleAverage(mean=_numbers(mean), sd=_numbers(deviation), n_cycles=len(whole))


def _numbers(values: np.ndarray) -> list[float | None]:
    return [float(value) if np.isfinite(value) else None for value in values]


def _contacts(trial: TrialKinetics) -> list[ContactEntry]:
    if trial.kinetics is None:
        return []
    return [
        ContactEntry(
            trial=trial.name,
            plate=contact.plate + 1,
            start_s=contact.start,
            end_s=contact.end,
            side=contact.side,
            accepted=contact.accepted,
            reason=contact.reason,
        )
        for contact in trial.kinetics.contacts
    ]


def kinetics_columns(kinetics: Kinetics) -> dict[str, np.ndarray]:
    """Columns of kinetics.csv, shape (n_frames,) each: curves in their units, centre of pressure [m], free moment.

    The free moment is in N*m/kg.
    """
    columns = {f"{side}_{name}": kinetics.curves[f"{side}_{name}"] for side in SIDES for name in UNITS}
    for side in SIDES:
        columns |= {f"{side}_pressure_{axis}": kinetics.pressure[side][:, k] for k, axis in enumerate("xyz")}
        columns[f"{side}_free_moment"] = kinetics.free_moment[side]
    return columns
