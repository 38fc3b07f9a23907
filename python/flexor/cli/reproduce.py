"""`flexor reproduce`: the published study, done again on this machine."""

from __future__ import annotations

import shlex
import time
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

import typer

from flexor.cli.console import err, out
from flexor.cli.evaluation import executor_if
from flexor.cli.options import Cluster
from flexor.cli.studies import ended_early
from flexor.errors import ClusterError

if TYPE_CHECKING:
    from flexor.paper import Doing, ItemDone

OUT = FilePath("reproduction")


def reproduce(
    folder: Annotated[
        FilePath, typer.Option("--out", help="Where to: figures, tables and report.html.")
    ] = OUT,
    only: Annotated[
        str | None,
        typer.Option(
            help="Only these items: some of `constants, fig3, fig4, table3, fig5, table4, fig6, "
            "readings, optimisers, conclusions`, with commas."
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with what is in the folder.")
    ] = False,
    constants: Annotated[
        str | None, typer.Option(help="The models' set of constants; `calibrated` by default.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Of everything drawn at random; 0 by default.")
    ] = None,
    cluster: Cluster = None,
    docs: Annotated[
        FilePath | None,
        typer.Option(help="Also write the findings as Markdown into this file, figures beside it."),
    ] = None,
) -> int:
    """Do the published study again, every figure and table, beside the published numbers.

    Takes some minutes on two cores. Every finished part is kept in the folder at once, so it can
    be interrupted (Ctrl-C) at any moment and resumed; resumed reports end as if never interrupted.

    For example:

    * `flexor reproduce`
    * `flexor reproduce --only fig4,table3 --out landscape`
    * `flexor reproduce --resume`
    """
    from dataclasses import replace

    from flexor import paper

    began = time.monotonic()
    settings = None
    if constants is not None or seed is not None:
        kept = paper.kept_settings(folder) if resume else paper.Settings()
        settings = replace(
            kept,
            constants=kept.constants if constants is None else constants,
            seed=kept.seed if seed is None else seed,
        )
    try:
        with executor_if(cluster) as executor, Telling() as told:
            done = paper.reproduce(
                folder,
                only,
                settings=settings,
                resume=resume,
                docs=docs,
                told=told,
                executor=executor,
            )
    except (KeyboardInterrupt, ClusterError) as error:
        return _interrupted(folder, error)
    from flexor.cli.progress import duration

    count, took = len(done.sections), duration(time.monotonic() - began)
    out.print(f"{count} item{'s' * (count != 1)} in {took}.", markup=False)
    out.print(f"report: {done.report}", markup=False, soft_wrap=True)
    if docs is not None:
        out.print(f"findings: {docs}", markup=False, soft_wrap=True)
    return 0


class Telling:
    """Tells what is being done on a live line, and of each finished item on a line of its own."""

    def __init__(self) -> None:
        self._status = err.status("")

    def __enter__(self) -> Telling:
        if err.is_interactive:
            self._status.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._status.stop()

    def __call__(self, news: Doing | ItemDone) -> None:
        """Take in what is being done, or what is finished."""
        from flexor.cli.progress import duration
        from flexor.paper import ItemDone

        if isinstance(news, ItemDone):
            section = news.section
            line = f"{section.name:<12} {duration(news.seconds):>7}   {section.title}"
            out.print(line, markup=False, soft_wrap=True)
            return
        share = "" if news.share is None else f" · {100.0 * news.share:.0f} %"
        self._status.update(f"{news.item} · {news.what}{share}")


def _interrupted(folder: FilePath, error: BaseException) -> int:
    begun = (folder / "reproduction.json").exists()
    where = "" if folder == OUT else f" --out {shlex.quote(str(folder))}"
    command = f"flexor reproduce --resume{where}" if begun else None
    return ended_early(error, "finished part", command)
