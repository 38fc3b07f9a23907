"""Settings of a study: everything that decides its numbers."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, is_dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from flexor.errors import InputError, shortened
from flexor.optimizers import Budget, Search
from flexor.study.environment import environment, installed
from flexor.study.problem import FloatArray, Problem
from flexor.study.schema import complete

FORMAT = 1
# What may differ when a study is resumed: when and with what it began, and how far it is to go.
_FREE = ("created", "budget", "environment")


@dataclass(frozen=True)
class Settings:
    """Settings of a study, as plain JSON values.

    Attributes
    ----------
    values : dict
        ``format``, ``flexor`` (version), ``environment`` (engine, Python, packages, system; see
        `flexor.study.environment`), ``created``, ``model`` (name, constants, hash),
        ``parameters`` (name, labels, units, bounds), ``objective`` (name, forces), ``method``
        (name, options), ``start``, ``seed``, ``engine`` (options) and ``budget``. Numbers are SI
        and read back exactly.
    """

    values: Mapping[str, Any]

    @classmethod
    def of(
        cls,
        problem: Problem,
        search: Search,
        start: FloatArray | None,
        seed: int,
        budget: Budget,
    ) -> Settings:
        """Describe a study; a ``start`` of None is drawn from the seed."""
        chosen = problem.parameters
        options: dict[str, Any] = {}
        if is_dataclass(search) and not isinstance(search, type):
            options = asdict(search)
        values = {
            "format": FORMAT,
            "flexor": installed("flexor"),
            "environment": environment(),
            "created": datetime.now(timezone.utc).isoformat(timespec="seconds"),
            "model": {
                "name": problem.model.name,
                "constants": problem.model.file.use,
                "hash": problem.model.hash,
            },
            "parameters": {
                "name": chosen.name,
                "labels": list(chosen.labels),
                "units": list(chosen.units),
                "lower": chosen.lower.tolist(),
                "upper": chosen.upper.tolist(),
            },
            "objective": {"name": problem.objective.name, "force": problem.force.tolist()},
            "method": {"name": search.name, "options": options},
            "start": None if start is None else start.tolist(),
            "seed": seed,
            "engine": dict(problem.options),
            "budget": asdict(budget),
        }
        return cls(json.loads(json.dumps(values)))

    @classmethod
    def read(cls, folder: Path) -> Settings:
        """Read the settings of a study folder.

        Raises
        ------
        InputError
            If the folder is not a study, or one that this version cannot read.
        """
        path = folder / "settings.json"
        if not path.is_file():
            what = "there is no such folder"
            if folder.exists():
                what = "it has no settings.json" if folder.is_dir() else "it is a file"
            raise InputError(f'"{folder}" is not a study: {what}.')
        try:
            values = json.loads(path.read_text(encoding="utf-8"))
            found = values["format"]
            # JSON can escape what is no text, and could then not be written again.
            json.dumps(values, ensure_ascii=False).encode("utf-8")
        except OSError as error:
            raise InputError(
                f'"{path}" cannot be read: {(error.strerror or str(error)).lower()}.'
            ) from error
        except (ValueError, KeyError, TypeError, RecursionError):
            raise InputError(f'"{path}" is damaged: it is not the settings of a study.') from None
        if found != FORMAT:
            raise InputError(
                f'"{path}" has format {shortened(repr(found))}; this version of Flexor reads '
                f"format {FORMAT}."
            )
        if not complete(values):
            raise InputError(f'"{path}" is damaged: it is not the settings of a study.')
        return cls(values)

    def write(self, folder: Path) -> None:
        """Write ``settings.json`` into a folder, in place of any that is there."""
        text = json.dumps(self.values, indent=2, ensure_ascii=False) + "\n"
        draft = folder / "settings.json.new"
        draft.write_text(text, encoding="utf-8")
        draft.replace(folder / "settings.json")

    def with_budget(self, budget: Budget) -> Settings:
        """Return the same settings with another budget."""
        return Settings({**self.values, "budget": asdict(budget)})

    def check_same(self, other: Settings, folder: Path) -> None:
        """Refuse to go on with a study under other settings.

        Raises
        ------
        InputError
            Naming the first setting that differs.
        """
        mine, theirs = dict(_flat(self.values)), dict(_flat(other.values))
        for key in [*mine, *(key for key in theirs if key not in mine)]:
            if key.split(".")[0] in _FREE or mine.get(key) == theirs.get(key):
                continue
            if key == "model.hash":
                raise InputError(
                    f'the study "{folder}" was made with a model "{mine["model.name"]}" that '
                    "differs from the one now given: resume it as it was or begin another."
                )
            raise InputError(
                f'the study "{folder}" was made with {key} = {_shown(mine.get(key))}, not '
                f"{_shown(theirs.get(key))}: resume it as it was or begin another."
            )


def _flat(values: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def _shown(value: Any) -> str:
    text = "nothing" if value is None else json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."
