"""What friction does to the paper's finger and to the demo: states, loops, and the best design.

The finger is loaded to 5 N and unloaded; the pneumatic finger is inflated to 60 kPa and deflated,
and searched for its best design with friction of the exosuit's skin.
"""

from __future__ import annotations

import argparse

import numpy as np
from _section import Section
from rich.table import Table

import flexor
from flexor.design import variables
from flexor.model import Path

COEFFICIENTS = (0.0, 0.2, 0.5)


def main() -> int:
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=50, help="load steps up, and as many down")
    parser.add_argument("--budget", type=int, default=300, help="designs of each search; 0: none")
    options = parser.parse_args()
    section = Section("Friction", "./dev bench friction")
    section.parts.append(_loops(options.steps))
    if options.budget:
        section.parts.append(_searches(options.budget))
    section.report()
    return 0


def _loops(steps: int) -> Table:
    table = Table("model", "friction", "bending", "half way up", "half way down", "left", "lost")
    cases = (
        ("finger, surface", ("finger", "surface"), "contacts.skin.friction", 5.0),
        ("finger, calibrated", ("finger", "calibrated"), "contacts.skin.friction", 5.0),
        ("pneumatic finger", ("pneumatic-finger", None), "bodies.exosuit.friction", 60e3),
    )
    up = np.linspace(0.0, 1.0, steps + 1)
    for title, (name, variant), field, most in cases:
        for friction in COEFFICIENTS:
            model = flexor.load(name, variant, changes={field: friction})
            path = model.equilibrium(most * np.concatenate([up, up[-2::-1]]))
            table.add_row(title, f"{friction:g}", *_loop(path, steps))
    return table


def _loop(path: Path, steps: int) -> list[str]:
    """Return angles at the top, half way up and down and at the end, and the energy lost."""
    if not path.converged.all():
        bad = int(np.flatnonzero(~path.converged)[0])
        return [f"{path.status[bad]} in step {bad}", "", "", "", ""]
    angle = np.degrees(path.joint_angles.sum(axis=1))
    places = (steps, steps // 2, 2 * steps - steps // 2, 2 * steps)
    lost = f"{1e3 * path.dissipated[-1]:.3g} mJ"
    return [*(f"{angle[place]:.2f}°" for place in places), lost]


def _searches(budget: int) -> Table:
    """Search for the best pneumatic finger, without its tolerances, from the one without friction.

    Its value without friction is that with the friction of each row; a search with friction starts
    there.
    """
    table = Table("friction", "the best without friction", "best", "best design")
    start: np.ndarray | None = None
    for friction in COEFFICIENTS:
        model = flexor.load("pneumatic-finger", changes={"bodies.exosuit.friction": friction})
        stated = model.file.design
        assert stated is not None
        study = flexor.optimize(
            model,
            variables(stated.varied, model, "variables"),
            stated.aims[0],
            subject_to=stated.subject_to,
            without=stated.without,
            budget=budget,
            start=start,
        )
        best = study.best
        start = best.vector if start is None else start
        before = study.problem.evaluate(start[None, :])
        kept = (
            ""
            if before.violation[0] == 0.0
            else f" (breaks a constraint by {before.violation[0]:.2g})"
        )
        shown = f"{before.shown[0]:.2f} {study.problem.unit}{kept}"
        table.add_row(f"{friction:g}", shown, best.result, best.text)
    return table


if __name__ == "__main__":
    raise SystemExit(main())
