"""A peak as a criterion of a nonlinear program."""

import casadi as ca
import numpy as np

from ..errors import ProblemError
from .problem import NLP


def with_peak(nlp: NLP, outputs: ca.SX, weight: ca.SX) -> NLP:
    r"""Add :math:`\theta \max_i h_i` to the objective of a nonlinear program.

    The largest of the outputs becomes a variable :math:`\gamma` of its own, the last one, below which all of them stay
    (goal attainment; the epigraph of the maximum, Boyd and Vandenberghe 2004, sec. 4.1.3):

    .. math::

        \underset{w, \gamma}{\text{minimize}} \; f + \theta \gamma \quad \text{subject to} \quad h_i - \gamma \le 0

    which is smooth, so it serves as a lower level whose weights are estimated. Outputs at nodes see a maximum between
    them only as closely as the grid does; `transcription.adjoint_simulation` refines it.

    Args:
        nlp: Problem without the peak.
        outputs: h in (nlp.w, nlp.p), for instance joint moments at all nodes, with both signs, shape (n_h, 1).
        weight: theta >= 0, an expression of nlp.p or a number, scalar.

    Raises:
        ProblemError: No outputs, or a weight that is not scalar.
    """
    if not outputs.numel() or outputs.shape[1] != 1:
        raise ProblemError(f"outputs must have shape (n_h, 1) with n_h > 0, got {outputs.shape}")
    if weight.numel() != 1:
        raise ProblemError(f"the weight of a peak must be scalar, got shape {weight.shape}")
    peak, n_h = ca.SX.sym("peak"), outputs.numel()
    return NLP(
        w=ca.vertcat(nlp.w, peak),
        p=nlp.p,
        f=nlp.f + weight * peak,
        g=ca.vertcat(nlp.g, outputs - peak),
        lbw=np.append(nlp.lbw, -np.inf),
        ubw=np.append(nlp.ubw, np.inf),
        lbg=np.append(nlp.lbg, np.full(n_h, -np.inf)),
        ubg=np.append(nlp.ubg, np.zeros(n_h)),
    )
