"""`flexor studio`: a model in a browser that solves again while its dimensions move."""

from __future__ import annotations

import socket
from typing import TYPE_CHECKING, Annotated

import typer

from flexor.cli import options
from flexor.cli.console import say
from flexor.cli.design_problem import is_given, stated
from flexor.cli.values import load_changed, one_or_assignments

if TYPE_CHECKING:
    from flexor.model import Model
    from flexor.study import Problem

PORT = 8765
# Options that state a design problem.
_STATEMENT = (
    *("parameters", "objective", "vary", "maximise", "minimise", "subject_to", "without"),
)


def studio(
    context: typer.Context,
    model: options.Model,
    parameters: options.Parameters = "L+R01",
    objective: options.Objective = "bending",
    vary: options.Vary = None,
    maximise: options.Maximise = None,
    minimise: options.Minimise = None,
    subject_to: options.SubjectTo = None,
    without: options.Without = None,
    force: options.Load = None,
    variant: options.Variant = None,
    changes: options.Set = None,
    host: Annotated[
        str,
        typer.Option(
            help="Address to listen at; one that other machines reach, such as `0.0.0.0`, needs "
            "the token that is printed."
        ),
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Port; 0 for any free one.")] = PORT,
    show: Annotated[
        bool, typer.Option("--open/--no-open", help="Open the browser, if there is a display.")
    ] = True,
) -> int:
    """Open a model in the browser, with sliders for its dimensions and loads.

    The path is solved again while a slider moves. The page also evaluates landscapes, runs
    searches, compares two designs, and saves model files, pictures, results and pages to share.
    Sliders are the variables of the file's `[design]`, of `--vary` or of a parameter set; Ctrl-C
    ends the studio.

    Examples
    --------
    * `flexor studio pneumatic-finger`
    * `flexor studio finger --parameters R01 --load 0:5:1`
    * `flexor studio pneumatic-finger --vary "exosuit.section.wall=1.5 mm:3 mm" --maximise bending`
    """
    from flexor.model.loads import loads
    from flexor.studio import serve, workbench

    loaded = load_changed(model, variant, changes)
    problem = _problem(
        context, loaded, parameters, objective, vary, maximise, minimise, subject_to, without
    )
    given = one_or_assignments("--load", force, "chamber=0:5:1")
    chosen = None if given is None else loads(given, loaded.input_dimensions)
    bench = workbench(loaded, problem, chosen, model)
    running = serve(bench, host, port)
    say(f"studio: {running.url}  (Ctrl-C ends it)")
    if host in ("0.0.0.0", "::"):
        reached = running.url.replace("[::]" if host == "::" else host, socket.gethostname(), 1)
        say(f"from other machines: {reached}")
    if show:
        _open(running.url)
    try:
        running.run()
    except KeyboardInterrupt:
        say("ended.")
    return 0


def _problem(
    context: typer.Context,
    model: Model,
    parameters: str,
    objective: str,
    vary: list[str] | None,
    maximise: list[str] | None,
    minimise: list[str] | None,
    subject_to: list[str] | None,
    without: list[str] | None,
) -> Problem | None:
    """Return what varies and what is wanted; None for a model that states neither."""
    from flexor.design import parameter_set
    from flexor.study import Problem

    if model.file.design is None and not any(is_given(context, name) for name in _STATEMENT):
        return None
    found = stated(context, model, objective, vary, maximise, minimise, subject_to, without)
    chosen = found.varied or parameter_set(parameters, model.design)
    return Problem.of(model, chosen, found.aim, subject_to=found.subject_to, without=found.without)


def _open(url: str) -> None:
    import os
    import sys
    import webbrowser

    desktop = sys.platform in ("win32", "darwin") or any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY")
    )
    if desktop:
        webbrowser.open(url)
