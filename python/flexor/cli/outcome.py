"""Output of a finished optimisation: summary, figure and JSON."""

from __future__ import annotations

import math
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any

from flexor.cli import verdict
from flexor.cli.console import err, say
from flexor.cli.folders import save_figure
from flexor.cli.progress import duration
from flexor.cli.table import number, show, with_unit

if TYPE_CHECKING:
    from flexor.study import Sensitivity, Study


_CAVEATS = {
    "snapped": "The optimum is reached through a snap: sensitivities hold on the final branch.",
    "contact-threshold": "A contact is about to open or close: sensitivities are one-sided.",
    "nearly-singular": "The optimum is nearly unstable: sensitivities hold for tiny changes only.",
    "no-equilibrium": "The optimum has no equilibrium, and hence no sensitivities.",
}


def print_summary(study: Study, seconds: float, resumed: bool = False) -> None:
    """Print start and optimum side by side, the improvement, and the cost."""
    rows = []
    for line in study.comparison():
        unit = f" / {line.unit}" if line.unit and line.unit != "1" else ""
        rows.append(
            (
                f"{line.label}{unit}",
                number(line.start),
                number(line.best),
                _change(line.start, line.best),
            )
        )
    if study.problem.constraints or study.problem.objective.of_observable:
        verdict.print_verdict(study.best)
    show(("", start_title(study), "optimum", "change"), rows)
    say(_improvement(study))
    if study.problem.objective.of_observable:
        verdict.print_tolerances(study.best)
    elif math.isfinite(study.best.value) and study.problem.model.joints:
        _print_sensitivity(study.best.sensitivity)
    cost = f"{'in total, resumed for' if resumed else 'in'} {duration(seconds)}"
    say(f"{study.evaluations:,} designs {cost}: {study.finished}.")


def start_title(study: Study) -> str:
    """Return the title of the starting design."""
    own = study.problem.parameters.start
    return "default" if list(study.start.vector) == list(own) else "start"


def draw(study: Study, also: FilePath | None, quiet: bool = False) -> None:
    """Save a figure of both designs to the study folder and another file; print the paths."""
    from flexor import plot

    with err.status("drawing the designs"):
        figure = plot.designs(study.start.path, study.best.path, (start_title(study), "optimum"))
        files = [plot.save(figure, also)] if also is not None else []
        if study.folder is not None:
            files += save_figure(figure, study.folder, "designs")
    if quiet:
        return
    if study.folder is not None:
        say(f"study:  {study.folder}")
    for file in files:
        say(f"figure: {file}")


def as_json(study: Study, seconds: float) -> dict[str, Any]:
    """Return the result as a JSON object, SI.

    `bending` and `joint_angles`, at the last load, are in rad, `tip_force` in N; for `sensitivity`
    see `_sensitivity`.
    """
    return {
        "objective": study.problem.objective.name,
        "force": float(study.problem.force[-1]),
        **{
            name: {
                "parameters": design.parameters,
                "value": design.value,
                "bending": design.bending,
                "joint_angles": design.joint_angles[-1].tolist(),
                "tip_force": float(design.tip_force[-1]),
            }
            for name, design in (("start", study.start), ("best", study.best))
        },
        "sensitivity": _sensitivity(study.best.sensitivity),
        "feasible": study.best.feasible,
        "constraints": verdict.constraints_as_json(study.best),
        "within_tolerances": verdict.within_as_json(study.best),
        "evaluations": study.evaluations,
        "seconds": seconds,
        "reason": study.finished,
        "folder": study.folder,
    }


def _print_sensitivity(found: Sensitivity) -> None:
    """Print the effect of a small change of each parameter on the optimum."""
    rows = []
    for k, (label, step) in enumerate(zip(found.labels, found.steps, strict=True)):
        slope = float(found.joint_angles[:, k].sum() * found.step[k])
        off = [
            "fails" if math.isnan(bending) else _signed(math.degrees(bending - found.bending))
            for bending in found.off[k].tolist()
        ]
        force = number(float(found.tip_force[k] * found.step[k]), 2)
        rows.append((f"{label} + {step}", _signed(math.degrees(slope)), force, *off))
    names = ("sensitivity", "bending", "tip force / N", "if decreased", "if increased")
    show(names, rows)
    say(
        "bending, tip force: slope times the step; if decreased, if increased: change of bending "
        "when a design is off by it."
    )
    if found.regularity != "regular":
        say(_CAVEATS[found.regularity])


def _sensitivity(found: Sensitivity) -> dict[str, Any]:
    """Return the derivatives with respect to each parameter, per SI unit, at the last load.

    `joint_angles` [rad], `tip_force` [N], `value` of the objective, `loss` [rad], the largest loss
    of bending for a change by ± `step`, and `regularity`.
    """
    return {
        "regularity": found.regularity,
        "parameters": {
            label: {
                "joint_angles": found.joint_angles[:, k].tolist(),
                "tip_force": float(found.tip_force[k]),
                "value": None if found.value is None else float(found.value[k]),
                "step": float(found.step[k]),
                "loss": float(found.tolerance[k]),
            }
            for k, label in enumerate(found.labels)
        },
    }


def _signed(degrees: float) -> str:
    text = f"{degrees:+.1f}"
    return "0.0°" if float(text) == 0.0 else f"{text.replace('-', '−')}°"


def _improvement(study: Study) -> str:
    start, best, first = study.start, study.best, start_title(study)
    force = study.problem.model.show_loads(study.problem.loads[-1])
    problem = study.problem
    if not math.isfinite(start.value):
        return f"At {force} the {first} {start.reason}; the optimum bends {_degrees(best.bending)}."
    if problem.quantity != "bending":
        return (
            f"At {force} the optimum's {problem.quantity} is "
            f"{with_unit(best.shown, problem.unit)}, that of the {first} "
            f"{with_unit(start.shown, problem.unit)}{_ratio(start.shown, best.shown)}."
        )
    return (
        f"At {force} the optimum bends {_degrees(best.bending)}, "
        f"the {first} {_degrees(start.bending)}{_ratio(start.bending, best.bending)}."
    )


def _ratio(start: float, best: float) -> str:
    return f" ({best / start:.2f} times as much)" if start > 0.0 and best > start else ""


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.1f}°"


def _change(start: float, best: float) -> str:
    change = best - start
    if not math.isfinite(change):
        return ""
    return number(change, 3) if change <= 0.0 else f"+{number(change, 3)}"
