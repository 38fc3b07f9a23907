"""Output of a finished optimisation: summary, figure and JSON."""

from __future__ import annotations

import math
from importlib import import_module
from pathlib import Path as FilePath
from threading import Thread
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.cli import verdict
from flexor.cli.console import say
from flexor.cli.folders import save_figure
from flexor.cli.progress import duration, working
from flexor.cli.table import number, show, with_unit
from flexor.design.drawn_file import drawn_file
from flexor.model.limbs import limbs
from flexor.study.ineffective import ineffective
from flexor.study.optimum import optimum_files
from flexor.study.sentences import title, without_effect

if TYPE_CHECKING:
    from flexor.study import Design, Sensitivity, Study


# Quantities that are sums over joints.
SUMS = ("bending", "range-of-motion")
_CAVEATS = {
    "snapped": "The optimum is reached through a snap: sensitivities hold on the final branch.",
    "contact-threshold": "A contact is about to open or close: sensitivities are one-sided.",
    "nearly-singular": "The optimum is nearly unstable: sensitivities hold for tiny changes only.",
    "no-equilibrium": "The optimum has no equilibrium, and hence no sensitivities.",
}


def print_summary(
    study: Study, best: Design, seconds: float, resumed: bool = False, cost: str | None = None
) -> None:
    """Print start and optimum side by side, the improvement, and the cost."""
    rows = []
    if checked := _has_verdict(best):
        _check(best)
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
    if checked:
        verdict.print_verdict(best)
    show(("", start_title(study), best_title(best), "change"), rows)
    for text in _improvement(study, best):
        say(text)
    if study.problem.objective.of_observable:
        verdict.print_tolerances(best)
    else:
        if math.isfinite(best.value) and study.problem.model.joints:
            _print_sensitivity(best.sensitivity)
        ends = np.stack([best.vector, study.problem.parameters.start])
        for text in without_effect(ineffective(study.problem, ends)):
            say(text)
    say(cost or cost_of(study, seconds, resumed))
    if checked and best.verdict.feasible and not best.verdict.robust:
        say(_search_on(study))


def _check(best: Design) -> None:
    with working(f"checking the best design, {best.result}") as progress:
        best.evaluate_verdict(progress)


def cost_of(study: Study, seconds: float, resumed: bool = False) -> str:
    """Return how many designs a study evaluated, in which time, and why it ended."""
    count = f"{study.evaluations:,} designs"
    if resumed and not study.evaluated:
        return f"{count} in total: nothing was left to evaluate: {study.finished}."
    more = f"in total, {study.evaluated:,} of them now in" if resumed else "in"
    return f"{count} {more} {duration(seconds)}: {study.finished}."


def _has_verdict(design: Design) -> bool:
    """Whether there is a verdict on a design."""
    return bool(design.problem.constraints) or design.problem.objective.of_observable


def _search_on(study: Study) -> str:
    """Return what may give a robust design."""
    text = "A robust design needs looser constraints, smaller tolerances, wider bounds"
    given = study.settings.values["budget"]["evaluations"]
    if study.folder is None or given is None:
        return f"{text}, or a longer search."
    where = f"flexor optimize --resume {study.folder} --budget {4 * given}"
    return f"{text}, or a longer search: {where}"


def start_title(study: Study) -> str:
    """Return the title of the starting design."""
    own = study.problem.parameters.start
    return "default" if list(study.start.vector) == list(own) else "start"


def best_title(best: Design) -> str:
    """Return what the best design is called."""
    return title(best.verdict) if _has_verdict(best) else "optimum"


def import_figures() -> None:
    """Import what draws figures beside a search, whose work is mostly the engine's."""

    def work() -> None:
        for name in ("figure", "backends.backend_agg", "backends.backend_svg"):
            import_module(f"matplotlib.{name}")

    Thread(target=work, daemon=True).start()


def draw(
    study: Study,
    best: Design,
    also: FilePath | None,
    quiet: bool = False,
    folder: FilePath | None = None,
) -> None:
    """Save a figure of both designs to the study folder and another file; print the paths.

    The optimum is that of a ``folder`` of several studies, by default of the study.
    """
    from flexor import plot

    with working("drawing the designs") as progress:
        chosen, model = study.problem.parameters, study.problem.model
        files = [drawn_file(chosen, each.vector, model) for each in (study.start, best)]
        titles = _titles(study, best)
        figure = plot.designs(study.start.path, best.path, titles, (files[0], files[1]))
        saved = []
        if also is not None:
            progress(also.name)
            saved.append(plot.save(figure, also))
        if study.folder is not None:
            saved += save_figure(figure, study.folder, "designs", progress=progress)
    if quiet:
        return
    if study.folder is not None:
        say(f"study:  {study.folder}")
        for file in optimum_files(folder or study.folder):
            say(f"model:  {file}")
    for file in saved:
        say(f"figure: {file}")


def _titles(study: Study, best: Design) -> tuple[str, str]:
    """Return the titles of both designs, with what they break in a line of its own."""
    first, last = (
        f"breaks {', '.join(broken)}\n{name}" if (broken := _broken(design)) else name
        for design, name in ((study.start, start_title(study)), (best, best_title(best)))
    )
    return first, last


def as_json(study: Study, best: Design, seconds: float) -> dict[str, Any]:
    """Return the result as a JSON object, SI.

    `bending` and `joint_angles`, at the last load, are in rad, `tip_force` in N, the largest
    `contact_pressure` along the path in Pa; `models` are model files of the best design. For
    `sensitivity` see `_sensitivity`.
    """
    _check(best)
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
            for name, design in (("start", study.start), ("best", best))
        },
        "sensitivity": _sensitivity(best.sensitivity),
        "feasible": best.verdict.feasible,  # as drawn
        "robust": best.verdict.robust if best.verdict.within else None,
        "constraints": verdict.constraints_as_json(best),
        "within_tolerances": verdict.within_as_json(best),
        "warnings": verdict.warnings_of(best),
        "without_effect": list(best.verdict.ineffective),
        "contact_pressure": None if best.verdict.pressure is None else best.verdict.pressure[0],
        "evaluations": study.evaluations,
        "seconds": seconds,
        "reason": study.finished,
        "folder": study.folder,
        "models": [] if study.folder is None else optimum_files(study.folder),
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


def _improvement(study: Study, best: Design) -> list[str]:
    """Return what start and best design reach, and which constraints the start breaks."""
    start, problem, first = study.start, study.problem, start_title(study)
    own, force = (
        problem.model.show_loads(problem.loads_of(each.vector)[-1]) for each in (start, best)
    )
    # Loads may be variables.
    there = "" if own == force else f" at {own}"
    name = best_title(best)
    if not math.isfinite(start.value):
        return [
            f"At {own} the {first} {start.reason}; the {name} bends {_degrees(best.bending)}"
            f"{f' at {force}' if there else ''}."
        ]
    broken = [f"{each} ({value})" for each, value in _broken(start).items()]
    comparable = not _broken(best) and not broken
    if problem.quantity != "bending":
        ratio = _ratio(start.shown, best.shown) if comparable else ""
        said = (
            f"At {force} the {problem.quantity} of the {name} is "
            f"{with_unit(best.shown, problem.unit)}, that of the {first} "
            f"{with_unit(start.shown, problem.unit)}{there}{ratio}."
        )
    else:
        ratio = _ratio(start.bending, best.bending) if comparable else ""
        said = (
            f"At {force} the {name} bends {_degrees(best.bending)}, "
            f"the {first} {_degrees(start.bending)}{there}{ratio}."
        )
    count = limbs(problem.model) if problem.quantity in SUMS else 1
    of_all = [f"It is the sum over all joints, of {count} limbs."] if count > 1 else []
    broke = [f"The {first} breaks {' and '.join(broken)}."] if broken else []
    return [said, *of_all, *broke]


def _broken(design: Design) -> dict[str, str]:
    """Return the constraints that a design does not keep as drawn, with their worst values."""
    if not math.isfinite(design.value):
        return {}
    return {each.name: each.value for each in design.kept if each.state == "BROKEN"}


def _ratio(start: float, best: float) -> str:
    return f" ({best / start:.2f} times as much)" if best > 1.005 * start > 0.0 else ""


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.1f}°"


def _change(start: float, best: float) -> str:
    change = best - start
    if not math.isfinite(change):
        return ""
    return number(change, 3) if change <= 0.0 else f"+{number(change, 3)}"
