"""A model or a study as one file that needs no network."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from flexor.constraints import chosen_constraints
from flexor.design.drawn_file import drawn_file
from flexor.errors import InputError
from flexor.store.environment import environment, installed
from flexor.viewer.blobs import Blobs
from flexor.viewer.page import page
from flexor.viewer.payload import Shown, design_payload

if TYPE_CHECKING:
    from flexor.arrays import Array
    from flexor.model import Model
    from flexor.study import Problem, Study

# What one page may take; loads are thinned out above it [bytes].
LIMIT = 3_000_000


def shared_designs(source: Model | Study) -> list[Shown]:
    """Return the designs of a model, as it is, or of a study, its optimum and its start.

    Of a front, the best design for each objective, and the start.

    Parameters
    ----------
    source
        A model or a study.

    Raises
    ------
    InputError
        If no design of the study succeeded, or the model's loads are not defined.
    """
    from flexor.study import Study
    from flexor.study.sentences import cautions, headline, title

    if isinstance(source, Study):
        if source.problem.objective.count:
            return _ends(source)
        problem, found = source.problem.nominal, source.best
        best, start = found.vector, source.start.vector
        shown = [problem_design(problem, best, "optimum")]
        if found.has_verdict:
            shown[0] = replace(
                shown[0],
                title=title(found.verdict),
                headline=headline(found.verdict),
                cautions=cautions(found),
            )
        if not np.array_equal(best, start):
            shown.append(problem_design(problem, start, "start"))
        return shown
    paths = source.evaluate(source.own_design, None, 1)
    stated = source.file.design
    asked, without = (stated.subject_to, stated.without) if stated else ((), ())
    kept = chosen_constraints(asked, without, source)
    return [Shown(source.name, paths, source.file, kept)]


def _ends(study: Study) -> list[Shown]:
    """Return the ends of a front, and the start."""
    problem, front, start = study.problem, study.front, study.start.vector
    if not len(front):
        shown = [problem_design(problem, study.best.vector, "least infeasible design")]
    else:
        aims: dict[int, list[str]] = {}
        for each, column in zip(front.objectives, front.values.T, strict=True):
            aims.setdefault(int(np.argmin(column)), []).append(each.name)
        shown = [
            problem_design(
                problem,
                front.designs[row],
                f"point {row + 1} of the front, to {' and '.join(names)}",
            )
            for row, names in aims.items()
        ]
    if all(not np.array_equal(each, start) for each in front.designs):
        shown.append(problem_design(problem, start, "start"))
    return shown


def problem_design(
    problem: Problem, vector: Array, title: str, loads: Array | None = None
) -> Shown:
    """Return one design (k,) of a problem with its path.

    Parameters
    ----------
    problem
        The problem.
    vector : (k,) array
        The design, SI.
    title
        What it is called.
    loads : (s, inputs) array
        Its loads; those of the problem unless given.
    """
    chosen, model = problem.parameters, problem.model
    designs, valid = chosen.designs(vector[None, :], model)
    if not valid.all():
        raise InputError(f"the design has a length or radius that is not positive: {vector}.")
    force = problem.loads if loads is None else loads
    paths = model.evaluate(designs, force, 1, **dict[str, Any](problem.options))
    units = ["" if unit == "1" else unit for unit in chosen.units]
    values = (vector / chosen.scale).tolist()
    return Shown(
        title=title,
        paths=paths,
        file=drawn_file(chosen, vector, model),
        constraints=problem.constraints,
        parameters=list(zip(chosen.labels, values, units, strict=True)),
    )


def share_page(source: Model | Study, origin: str = "") -> str:
    """Return a model or a study as an HTML page of less than 3 MB.

    Parameters
    ----------
    source
        A model, shown as it is, or a study: its optimum, or the ends of its front, and its start
        for comparison.
    origin
        The file or folder that it came from, for provenance.

    Raises
    ------
    InputError
        As `shared_designs`, or if the file that says whom a size serves is damaged.
    """
    from flexor.study import Study
    from flexor.study.wearers_served import served

    study = source if isinstance(source, Study) else None
    size = None if study is None else served(study)
    model = source.problem.model if isinstance(source, Study) else source
    designs = shared_designs(source)
    steps = len(designs[0].paths.loads)
    every = 1
    while True:
        kept = np.unique(np.append(np.arange(0, steps, every), steps - 1))
        blobs = Blobs(compressed=True)
        thinned = [_thinned(each, kept) for each in designs]
        data = {
            "title": model.title or model.name,
            "name": model.name,
            "designs": [design_payload(each, blobs) for each in thinned],
            "blobs": blobs.table,
            "provenance": provenance(model, study, origin),
            "serves": None if size is None else [size.sentence, list(size.wearers)],
            "note": f"Every {every}th load step is shown." if every > 1 else "",
        }
        text = page(str(data["title"]), ["share.js"], data)
        if len(text.encode()) < LIMIT or len(kept) <= 2:
            return text
        every *= 2


def provenance(model: Model, study: Study | None, origin: str) -> list[list[str]]:
    """Return where a design comes from: pairs of a name and a text."""
    here = environment()
    rows = [
        ["Flexor", installed("flexor")],
        ["engine", f"{here['engine_path']}, {here['engine']}"],
        ["numpy", here["numpy"]],
        ["model", f"{model.name}, {model.hash[:12]}"],
    ]
    if origin:
        rows.append(["file", origin])
    if model.file.use:
        rows.append(["variant", str(model.file.use)])
    if study is not None:
        values = study.settings.values
        rows += [
            ["objective", str(values["objective"]["name"])],
            ["method", str(values["method"]["name"])],
            ["seed", str(values["seed"])],
            ["designs evaluated", f"{study.evaluations:,}"],
            ["ended", study.finished or "not finished"],
        ]
    return rows


def _thinned(design: Shown, kept: Array) -> Shown:
    if len(kept) == len(design.paths.loads):
        return design
    steps: Any = kept  # an array of indices, not typed among the keys of paths
    return replace(design, paths=design.paths[:, steps])
