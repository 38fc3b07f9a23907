"""Reproduce the published study: compute, draw, write."""

from __future__ import annotations

import os
import platform
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from flexor.errors import InputError, unknown
from flexor.model import load
from flexor.paper import items as study
from flexor.paper import published
from flexor.paper.context import FINGER, Context, Doing
from flexor.paper.folder import Folder
from flexor.paper.page import page
from flexor.paper.provenance import provenance
from flexor.paper.section import Picture, Section
from flexor.paper.settings import Settings
from flexor.paper.summary import summary
from flexor.paper.table_file import as_csv
from flexor.plot import save
from flexor.plot.style import style
from flexor.store import Lock
from flexor.study import Executor, chosen_executor

# Of the images in the documentation; those in `figures/` and in the report are finer.
DOCS_DPI = 120


@dataclass(frozen=True)
class ItemDone:
    """An item that is finished.

    Attributes
    ----------
    section : Section
        What it came to.
    seconds : float
        How long that took now [s].
    """

    section: Section
    seconds: float


@dataclass(frozen=True)
class Reproduction:
    """A finished reproduction.

    Attributes
    ----------
    folder : Path
        Where everything is.
    report : Path
        The HTML page.
    sections : tuple of Section
        What the items came to, in the order of the report.
    computing, drawing : float
        Processor time of all parts when they were computed, and of drawing and writing now [s].
    """

    folder: Path
    report: Path
    sections: tuple[Section, ...]
    computing: float
    drawing: float


Told = Callable[[Doing | ItemDone], None]


def reproduce(
    out: str | Path = "reproduction",
    only: str | Iterable[str] | None = None,
    *,
    settings: Settings | None = None,
    resume: bool = False,
    docs: str | Path | None = None,
    told: Told | None = None,
    executor: Executor | str | None = None,
) -> Reproduction:
    """Reproduce the published study.

    Parameters
    ----------
    out : path
        Folder for figures, tables and report; see `flexor.paper.folder`.
    only : str or iterable of str, optional
        Items, all by default; when resuming, those asked for before.
    settings : Settings, optional
        What decides the numbers; when resuming, those of the folder.
    resume : bool
        Go on with what is in the folder.
    docs : path, optional
        Also write the findings as Markdown into this file, and the figures into
        ``images/reproduction/`` beside it.
    told : callable, optional
        Told a `Doing` now and then and an `ItemDone` after each item.
    executor : Executor or str, optional
        Where searches, landscapes and comparisons are computed; as for `flexor.optimize`.

    Returns
    -------
    Reproduction
        Where everything is.

    Raises
    ------
    InputError
        If an item or a set of constants is not known, or the folder or the cluster cannot be used.
    ClusterError
        If the cluster is lost on the way; the reproduction can be resumed.
    """
    named = None if only is None else study.chosen(only)
    if isinstance(executor, str):
        with chosen_executor(executor) as cluster:
            return reproduce(
                out, named, settings=settings, resume=resume, docs=docs, told=told, executor=cluster
            )
    place = Path(out)
    if resume:
        folder = Folder.resume(place)
        chosen = _check_same(folder, settings)
    else:
        chosen = settings or Settings()
        _check_constants(chosen.constants)
        folder = Folder.create(
            place,
            {"settings": chosen.to_dict(), "provenance": provenance(chosen), "items": []},
        )
    lock = Lock(place)
    try:
        names = folder.ask_for(named or (() if folder.stamp["items"] else study.chosen(None)))
        names = tuple(name for name in study.ITEMS if name in names)
        tell = told or (lambda _: None)
        return _carry_out(Context(chosen, folder, tell, executor=executor), names, docs, tell)
    finally:
        lock.release()


def kept_settings(out: str | Path) -> Settings:
    """Return the settings of a reproduction that was begun.

    Parameters
    ----------
    out : path
        Its folder.

    Raises
    ------
    InputError
        If there is none.
    """
    return Settings.from_dict(Folder.resume(Path(out)).stamp["settings"])


def _carry_out(
    context: Context, names: tuple[str, ...], docs: str | Path | None, told: Told
) -> Reproduction:
    folder = context.folder
    sections: dict[str, Section] = {}
    images: dict[str, bytes] = {}
    drawing = 0.0
    for name in names:
        began = time.perf_counter()
        context.item = name
        section = sections[name] = study.ITEMS[name](context)
        computed = time.process_time()
        context.say("drawing and writing")
        for picture in section.pictures:
            images[picture.name] = _drawn(picture, folder.path / "figures")
        for table in section.all_tables:
            folder.write(f"tables/{table.name}.csv", as_csv(table))
        drawing += time.process_time() - computed
        told(ItemDone(section, time.perf_counter() - began))
    # What is concluded comes first.
    order = tuple(sorted(sections.values(), key=lambda section: section.name != "conclusions"))
    computing = folder.processor()
    about: Mapping[str, str] = folder.stamp["provenance"]
    took = (
        f"{computing:.0f} s of processor time for computing, {drawing:.0f} s for drawing; "
        f"{os.cpu_count()} cores, {platform.system()} {platform.machine()}"
    )
    report = folder.write("report.html", page(order, images, about, took, _lead()))
    if docs is not None:
        _write_docs(Path(docs), order, about)
    return Reproduction(folder.path, report, order, computing, drawing)


def _lead() -> str:
    return (
        "“Modelling and Design Optimization of a Soft-exosuit for Wearable Assistive Devices”, "
        "done again with Flexor: every published number beside ours. The searches of the paper's "
        f"tables add up to {published.hours():.0f} hours on six cores."
    )


def _check_constants(name: str) -> None:
    allowed = load(FINGER).file.constants
    if name not in allowed:
        raise unknown("set of constants", name, allowed)


def _check_same(folder: Folder, settings: Settings | None) -> Settings:
    """Return the folder's settings, if they are those wanted and give the same numbers still."""
    kept = Settings.from_dict(folder.stamp["settings"])
    if settings is not None and settings != kept:
        mine, theirs = settings.to_dict(), kept.to_dict()
        key = next(key for key in mine if mine[key] != theirs[key])
        raise InputError(
            f'the reproduction in "{folder.path}" was made with {key} = {theirs[key]}, not '
            f"{mine[key]}: resume it as it was or begin another."
        )
    before, now = folder.stamp["provenance"], provenance(kept)
    for key, value in now.items():
        if before.get(key) != value:
            raise InputError(
                f'the reproduction in "{folder.path}" was made with {key} {before.get(key)}, now '
                f"it is {value}: begin another."
            )
    return kept


def _write_docs(file: Path, sections: tuple[Section, ...], about: Mapping[str, str]) -> None:
    images = file.parent / "images" / "reproduction"
    try:
        images.mkdir(parents=True, exist_ok=True)
        for section in sections:
            for picture in section.pictures:
                with style():
                    picture.figure.savefig(images / f"{picture.name}.png", dpi=DOCS_DPI)
        text = summary(sections, about, _lead(), "images/reproduction")
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise InputError(f'"{file}" cannot be written: {why}.') from error


def _drawn(picture: Picture, place: Path) -> bytes:
    """Write a picture as SVG and PNG; return the latter."""
    place.mkdir(exist_ok=True)
    save(picture.figure, place / f"{picture.name}.svg")
    return save(picture.figure, place / f"{picture.name}.png").read_bytes()
