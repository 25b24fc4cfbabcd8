"""Sections of the weights: words, bars, table, fit, comparison, strides, certificate, walk."""

from collections.abc import Mapping

import numpy as np

from .blocks import Block, Paragraph, Section, bullets, missing, paragraph, picture, section, table
from .formatting import ABSENT, fixed, label, plain, rows_of
from .result import Result, Weights, mapping, real, reals, sequence
from .weights_figure import fit_figure, weights_figure
from .wording import CAVEAT, cohort_weights, spoken, weights_in_words

NOT_CONVERGED = "Not converged: what follows is the last iterate, not a result."
_SOLVER_WORDS = {
    "status": "Status",
    "kkt_residual": "KKT residual, recomputed (accepted below 1e-6)",
    "reduced_hessian": "Reduced Hessian, inertia test",
    "iterations": "Iterations",
    "seconds": "Time [s]",
    "tracking_rms_rad": "Tracking of the measured walk, rms [rad]",
    "tracking_seconds": "Time for tracking [s]",
    "regularisation_share": "Share of the cost paid by the regularisation",
    "message": "Message",
}


def weights_sections(result: Result) -> tuple[Section, ...]:
    """Everything about the weights, marked where the computation did not converge."""
    title = "What the walk trades off"
    weights = result.weights
    if weights is None or not weights.criteria:
        why = "they were not asked for, or the computation stopped before them; see the warnings"
        return (section(title, missing("weights of the criteria", why)),)
    notes = [str(note) for note in sequence(weights.document.get("notes"))]
    parts = [
        None if weights.converged else paragraph(NOT_CONVERGED, "stamp"),
        paragraph(" ".join(weights_in_words(weights, cohort_weights(result)))),
        paragraph(CAVEAT, "caveat"),
        picture(weights_figure(weights)),
        _dots_note(weights),
        *_weights_tables(weights),
        bullets(notes) if notes else None,
    ]
    first = section(title, *parts, kind="" if weights.converged else "unsolved")
    return (first, _fit(weights), *_strides(weights), _certificate(weights))


def _dots_note(weights: Weights) -> Paragraph:
    words = "Bars: weight; whiskers: one standard deviation; hatched: not identifiable."
    several = len(sequence(weights.document.get("strides"))) > 1
    return paragraph(words + (" Dots below a bar: the weight of each single stride." if several else ""), "note")


def _weights_tables(weights: Weights) -> tuple[Block, Block]:
    rows = [
        (
            spoken(c.name),
            fixed(c.weight, 3),
            fixed(c.sd, 3),
            ("yes" if c.identifiable else "no") + (", at zero bound" if c.at_bound else ""),
            plain(c.raw),
            ABSENT if c.share is None else f"{100.0 * c.share:.1f} %",
        )
        for c in weights.criteria
    ]
    header = ("criterion", "weight", "sd", "identifiable", "raw weight", "share of cost")
    return table(header, rows, "Weights of the criteria"), _correlation(weights)


def _correlation(weights: Weights) -> Block:
    if weights.correlation is None:
        return missing("correlation of the weights", "result.json holds none")
    names = [spoken(criterion.name) for criterion in weights.criteria]
    cells = [[fixed(float(v), 2) if np.isfinite(v) else ABSENT for v in row] for row in weights.correlation]
    rows = [(name, *row) for name, row in zip(names, cells, strict=True)]
    return table(("", *names), rows, "Correlation of the weights' estimates")


def _fit(weights: Weights) -> Section:
    title = "How well the model fits"
    if weights.fit_rms is None:
        return section(title, missing("fit", "result.json holds none"))
    if weights.comparison:
        beside: Block | None = picture(fit_figure(weights.fit_rms, weights.comparison))
    else:
        beside = missing("comparison with other weights", "it was not computed")
    rows = [_fit_row(name, rms) for name, rms in weights.per_joint.items()]
    rows.append(("all", f"{np.degrees(weights.fit_rms):.2f}", f"{weights.fit_rms:.4f}"))
    joints = table(("joint", "rms [deg]", "rms [rad]"), rows, "Model-optimal minus measured angles")
    unseen = reals(mapping(weights.document.get("fit")).get("unseen_stride_rms_rad"))
    others = [(name, f"{np.degrees(rms):.2f}", f"{rms:.4f}") for name, rms in unseen.items()]
    caption = "The same weights on strides that were not used to find them"
    seen = table(("stride", "rms [deg]", "rms [rad]"), others, caption) if others else None
    return section(title, beside, joints, seen)


def _fit_row(name: str, rms: float) -> tuple[str, str, str]:
    """A row of the table of joints; the position of the pelvis is a length, counted as 1 m = 1 rad in the total."""
    if name == "pelvis_position":
        return spoken(name), "–", f"{rms:.4f} m"
    return spoken(name), f"{np.degrees(rms):.2f}", f"{rms:.4f}"


def _strides(weights: Weights) -> tuple[Section, ...]:
    strides = [mapping(stride) for stride in sequence(weights.document.get("strides"))]
    pooled = mapping(weights.document.get("pooled"))
    if len(strides) < 2 and not pooled:
        return ()
    names = [criterion.name for criterion in weights.criteria]
    header = ("stride", *(spoken(name) for name in names), "fit rms [rad]", "status")
    rows = [
        (_stride_name(stride), *_numbers(stride.get("weights"), names), *_stride_state(stride)) for stride in strides
    ]
    if pooled:
        rows.append(("pooled", *_numbers(pooled.get("weights"), names), ABSENT, ABSENT))
        rows.append(("sd between strides", *_numbers(pooled.get("between_stride_sd"), names), ABSENT, ABSENT))
    return (section("Strides", table(header, rows, "Weights of each stride, and pooled")),)


def _stride_name(stride: Mapping[str, object]) -> str:
    start, end = real(stride.get("start_s")), real(stride.get("end_s"))
    span = "" if start is None or end is None else f" {start:.2f}–{end:.2f} s"
    return f"{stride.get('trial') or 'stride'} {stride.get('side') or ''}{span}"


def _numbers(values: object, names: list[str]) -> list[str]:
    return [fixed(real(mapping(values).get(name)), 3) for name in names]


def _stride_state(stride: Mapping[str, object]) -> tuple[str, str]:
    status = mapping(stride.get("solver")).get("status")
    return fixed(real(stride.get("fit_rms_rad")), 4), ABSENT if status is None else str(status).replace("_", " ")


def _certificate(weights: Weights) -> Section:
    if not weights.solver:
        return section("Certificate", missing("certificate", "result.json holds none, so nothing here is certified"))
    given = {_SOLVER_WORDS.get(key, label(key)): value for key, value in weights.solver.items() if value != ""}
    rows = [row for name, value in given.items() for row in rows_of(value, name)]
    verdict = (
        "Accepted: gaitlab recomputed the optimality conditions and they hold."
        if weights.converged
        else "Not accepted: the optimality conditions do not hold to the tolerance."
    )
    return section("Certificate", paragraph(verdict, "lead"), table(("", "value"), rows, kind="facts"))
