"""Derivatives of a mechanical model at one point, as functions to be mapped over all points of a problem."""

from collections.abc import Mapping

import casadi as ca

from ..nlp.codegen import compile_derived
from ..ocp.mechanical import MechanicalModel


def compiled_point_functions(model: MechanicalModel, name: str) -> dict[str, ca.Function]:
    """`point_functions`, compiled and cached under a name."""

    def build() -> list[ca.Function]:
        return list(point_functions(model).values())

    symbols = [model.q, model.v, model.a, model.f, model.p, model.d, model.y]
    results = [model.outputs, model.criteria, model.positions, model.velocities]
    return compile_derived(ca.Function("model", symbols, results), build, name)


def point_functions(model: MechanicalModel) -> dict[str, ca.Function]:
    r"""Functions at a collocation point and at a node, with z = (q, v, a, f), x = (q, v).

    * ``outputs``: (z, p) -> y
    * ``output_jacobian``: (z, p) -> dy/dz
    * ``output_hessian``: (z, p, mu) -> Hessian of mu' y in z
    * ``criteria``: (y, v, p, d) -> c
    * ``criteria_derivatives``: (y, v, p, d, theta) -> gradient and Hessian of theta' c in (y, v)
    * ``criteria_jacobian``: (y, v, p, d) -> dc/d(y, v)
    * ``node_values``: (x, p) -> contact positions and velocities
    * ``node_derivatives``: (x, p, mu) -> their Jacobian in x and the Hessian of mu' (positions, velocities)
    """
    z, x = ca.vertcat(model.q, model.v, model.a, model.f), ca.vertcat(model.q, model.v)
    yv = ca.vertcat(model.y, model.v)
    theta, mu_y = ca.SX.sym("theta", model.criteria.numel()), ca.SX.sym("mu_y", model.y.numel())
    contact = ca.vertcat(model.positions, model.velocities)
    mu = ca.SX.sym("mu", contact.numel())
    hessian, _ = ca.hessian(ca.dot(mu_y, model.outputs), z)
    criteria_hessian, criteria_gradient = ca.hessian(ca.dot(theta, model.criteria), yv)
    contact_hessian, _ = ca.hessian(ca.dot(mu, contact), x)
    p, d, y, v = model.p, model.d, model.y, model.v
    table: Mapping[str, tuple[list[ca.SX], list[ca.SX]]] = {
        "outputs": ([z, p], [model.outputs]),
        "output_jacobian": ([z, p], [ca.jacobian(model.outputs, z)]),
        "output_hessian": ([z, p, mu_y], [hessian]),
        "criteria": ([y, v, p, d], [model.criteria]),
        "criteria_derivatives": ([y, v, p, d, theta], [criteria_gradient, criteria_hessian]),
        "criteria_jacobian": ([y, v, p, d], [ca.jacobian(model.criteria, yv)]),
        "node_values": ([x, p], [contact]),
        "node_derivatives": ([x, p, mu], [ca.jacobian(contact, x), contact_hessian]),
    }
    return {
        name: ca.Function(name, inputs, [ca.densify(o) for o in out], {"cse": True})
        for name, (inputs, out) in table.items()
    }
