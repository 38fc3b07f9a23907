"""soromox: geometric variable strain in JAX, differentiated by JAX, designs under `vmap`."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import numpy as np
from _contest import Contest
from _rods import (
    DENSITY,
    GRAVITY,
    LENGTH,
    MODES,
    RADII,
    TENDON,
    YOUNG,
    random_radii,
    tapered,
    tendon_rod,
)
from _section import Missing
from numpy.typing import NDArray

Array = NDArray[np.float64]
DEGREE, POINTS = 3, 8
STEPS = 5
FORCE = 5.0  # N, of the tendon
TOLERANCE = 1e-10  # of a Newton step, against coordinates of order one
SELECTED = ("kappa_x", "kappa_y", "kappa_z", "sigma_x", "sigma_y", "sigma_z")


def contests(quick: bool) -> list[Contest]:
    """Residual and derivative of a batch, and its equilibria."""
    try:
        import jax
        import soromox
    except ImportError:
        raise Missing("soromox") from None
    jax.config.update("jax_enable_x64", True)
    name = f"soromox {version('soromox')} (JAX {jax.__version__})"
    assert soromox
    count = 16 if quick else 64
    strain = {mode: {"basis": "legendre", "order": DEGREE} for mode in MODES}
    model = tendon_rod(strain, 1, POINTS, GRAVITY)
    radii = random_radii(count)
    geometry = tapered(model, radii)
    states = np.random.default_rng(1).uniform(-0.1, 0.1, (count, model.dof))
    both, equilibria = _compiled(jax)
    indices, values = model.geometry_slots(geometry)
    parameters = np.tile(model.parameters, (count, 1))
    parameters[:, indices] = values
    engine, loads = model.engine, np.linspace(0.0, FORCE, STEPS + 1)

    def tangents() -> Array:
        rows = zip(parameters, states, strict=True)
        return np.stack([engine.tangent(p, q, [FORCE]) for p, q in rows])

    def residuals() -> Array:
        rows = zip(parameters, states, strict=True)
        return np.stack([engine.residual(p, q, [FORCE]) for p, q in rows])

    def compare_terms() -> tuple[float, str]:
        found = [np.asarray(part) for part in both(states, radii)]
        ours = residuals(), tangents()
        pairs = zip(found, ours, strict=True)
        return max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in pairs), ""

    def compare_equilibria() -> tuple[float, str]:
        path = model.evaluate(geometry, loads, threads=1)
        return float(np.abs(np.asarray(equilibria(radii)) - path.q[:, -1]).max()), ""

    problem = f"a rod with six strains, {model.dof} DOF, weight and tendon"
    return [
        Contest(
            name,
            f"residual and its exact derivative, {count} designs and states of {problem}",
            "soromox's function is compiled for the batch and differentiated forward; Flexor is "
            "called from Python for each state and makes a new workspace each time",
            lambda: jax.block_until_ready(both(states, radii)),
            tangents,
            (count, count),
            compare_terms,
            1e-6,
            "residual and derivative (soromox's Gauss points are accurate to 1e-8)",
        ),
        Contest(
            name,
            f"equilibria of {count} designs of {problem}, 0 to {FORCE:g} N in {STEPS} steps",
            "soromox has no static solver: Newton's method without a safeguard, written for this, "
            "under `vmap`, in which all designs wait for the slowest; Flexor follows the branch "
            "and tells stable from unstable",
            lambda: jax.block_until_ready(equilibria(radii)),
            lambda: model.evaluate(geometry, loads, threads=1),
            (count, count),
            compare_equilibria,
            1e-5,
            "coordinates at the last force",
        ),
    ]


def _compiled(jax: Any) -> tuple[Any, Any]:
    """Compile residual with derivative, and Newton's method through the forces."""
    from soromox.systems.components import IsotropicMaterialParams

    numpy, robot = jax.numpy, _robot()
    section = robot.params.link.cross_section
    material = IsotropicMaterialParams(
        young_modulus=numpy.array([YOUNG]), shear_modulus=numpy.array([YOUNG / 3.0])
    )

    def residual(q: Any, radii: Any, force: Any) -> Any:
        design = robot.update_link_params(cross_section=section.replace(coefficients=radii[None]))
        design = design.with_isotropic_material(material)
        elastic = design.stiffness_matrix() @ q
        tendon = design.actuation_matrix(q) @ numpy.array([force])
        return elastic - tendon + design.gravitational_force(q)

    def both(q: Any, radii: Any, force: Any) -> Any:
        return residual(q, radii, force), jax.jacfwd(residual)(q, radii, force)

    def equilibrium(radii: Any) -> Any:
        def step(q: Any, force: Any) -> Any:
            def unfinished(state: Any) -> Any:
                return (state[1] > TOLERANCE) & (state[2] < 50)

            def newton(state: Any) -> Any:
                value, derivative = both(state[0], radii, force)
                change = numpy.linalg.solve(derivative, -value)
                return state[0] + change, numpy.abs(change).max(), state[2] + 1

            q, _, _ = jax.lax.while_loop(unfinished, newton, (q, numpy.inf, 0))
            return q, None

        rest = numpy.zeros(robot.stiffness_matrix().shape[0])
        return jax.lax.scan(step, rest, numpy.linspace(0.0, FORCE, STEPS + 1))[0]

    terms = jax.jit(jax.vmap(lambda q, radii: both(q, radii, FORCE)))
    return terms, jax.jit(jax.vmap(equilibrium))


def _robot() -> Any:
    from soromox.actuation import threadlike
    from soromox.systems import components, gvs

    base, tip = (np.array([(0.0, *end)]) for end in TENDON)
    routing = threadlike.ThreadlikeRouting.linear(
        intercept=base,
        slope=(tip - base) / LENGTH,
        start_segment_index=(0,),
        end_segment_index=(0,),
    )
    segment = gvs.GVSSegment(
        link=components.LinkSpec.circular(
            length=LENGTH,
            radius=components.LinearProfile(*RADII),
            density=DENSITY,
            reference_strain=[0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
            young_modulus=YOUNG,
            shear_modulus=YOUNG / 3.0,
        ),
        joint=components.JointSpec(type="fixed"),
        basis=gvs.StrainBasisSpec("legendre", SELECTED, DEGREE),
        num_gauss_points=POINTS,
    )
    return gvs.GVS.from_segments(
        [segment],
        gravity=np.array(GRAVITY),
        base_pose=np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
        scale_rotational_basis_by_length=True,
        actuators=threadlike.ThreadlikeActuator.tendons(routing),
    )
