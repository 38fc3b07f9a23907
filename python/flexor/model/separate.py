"""Following the equilibria of a model whose components do nothing to one another, each by itself.

A snap of one then costs no steps of the others, and the work is that of small systems. Loads,
designs and results are those of the whole model.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexor import _engine
from flexor._engine import REGULARITY, STABILITY, STATUS
from flexor.arrays import Array
from flexor.model.engine_errors import engine_errors
from flexor.model.in_plane import InPlane, in_plane, in_space
from flexor.model.result_arrays import joinings

Indices = NDArray[np.intp]
Found = Mapping[str, Any]

_NO_ROWS = np.zeros(0, dtype=np.intp)
_EQUILIBRIA = [STATUS.index("converged"), STATUS.index("unstable")]
_NOT_REACHED = STATUS.index("not-reached")
# Groups of outputs that every component has in full: sums, largest values, and those of materials,
# which all components share. Of any other group each has the rows of its own entries.
_COMMON = {"tip_force", "max_overlap", "max_centreline_depth", "max_contact_pressure", "stretch"}
# From what is worst to what is best.
_STABILITY = ("unknown", "unstable", "flutter-undecided", "neutral", "stable")
_REGULARITY = ("no-equilibrium", "nearly-singular", "contact-threshold", "tied")
# How what has one row for each entry of its kind is joined.
_JOININGS = joinings()
_KINDS = {joining.of for joining in _JOININGS.values() if joining.of}


@dataclass(frozen=True, eq=False)
class _Component:
    """A component, and where what it has is in the whole model."""

    engine: _engine.Model
    plane: InPlane | None  # the same in its plane, if it cannot leave one
    slots: Indices  # the whole model's parameter of each of its own
    rows: Mapping[str, Indices]  # by what they are, see `flexor.model.joining`
    outputs: Indices  # the whole model's output of each of its own

    @property
    def coordinates(self) -> Indices:
        """The whole model's coordinate of each of its own."""
        return self.rows["coordinates"]

    @property
    def inputs(self) -> Indices:
        """The whole model's input of each of its own."""
        return self.rows["inputs"]

    def of(self, which: Indices) -> tuple[Indices, Indices]:
        """Return which of some parameters of the whole model it has, and which of its own."""
        order = np.argsort(self.slots, kind="stable")
        place = np.searchsorted(self.slots, which, sorter=order)
        place = order[np.minimum(place, len(order) - 1)]
        has = np.flatnonzero(self.slots[place] == which)
        return has, place[has]


class Separate:
    """The components of a model, in place of its engine where paths are followed."""

    def __init__(
        self,
        whole: _engine.Model,
        description: Mapping[str, Any],
        components: Sequence[Mapping[str, Any]],
    ) -> None:
        self.whole = whole
        self.components = [_component(each, whole, description) for each in components]
        self._sizes = {kind: len(names) for kind, names in _kinds(whole, description).items()}
        several = np.zeros(_count(whole.outputs), dtype=int)
        for each in self.components:
            several[each.outputs] += 1
        # The largest of what several components have is that of the whole model.
        self._common = np.flatnonzero(several > 1)
        start, stop = whole.outputs["tip_force"]
        self._common = self._common[(self._common < start) | (self._common >= stop)]

    def path(
        self,
        slot_indices: Indices,
        values: Array,
        loads: Array,
        threads: int = 0,
        *,
        steps: int,
        start: Array | None = None,
        **settings: Any,
    ) -> dict[str, Any]:
        """Follow designs; see `flexor._engine.Model.path`."""
        count = len(values)
        found = []
        for each in self.components:
            has, own = each.of(np.asarray(slot_indices, dtype=np.intp))
            column = np.ascontiguousarray(loads[:, each.inputs])
            varied = np.ascontiguousarray(values[:, has])
            engine = each.engine
            if each.plane is not None:
                planar = each.plane.parameters(own, varied)
                if planar is not None:
                    engine, (own, varied) = each.plane.engine, planar
            # Designs that differ in other components only are followed once.
            of = _distinct(varied) if count > 1 and len(loads) == steps else None
            if of is not None:
                varied = varied[np.unique(of, return_index=True)[1]]
            given = dict(settings)
            if start is not None:
                given["start"] = np.ascontiguousarray(start[each.coordinates])
            with engine_errors():
                one: Any = engine.path(own, varied, column, threads, steps=steps, **given)
            if engine is not each.engine:
                one = in_space(one)
            found.append(one if of is None else _taken(one, of))
        return self._together(found, loads, count, steps)

    def differentiate(
        self,
        slot_indices: Indices,
        values: Array,
        designs: Indices,
        q: Array,
        applied: Array,
        sums: Indices,
        weights: Array,
        wanted: Indices,
        threads: int = 0,
    ) -> dict[str, Any]:
        """Differentiate at known equilibria; see `flexor._engine.Model.differentiate`."""
        by_parameters = np.zeros((len(sums), len(wanted)))
        by_loads = np.zeros((len(sums), len(self.whole.inputs)))
        regularity = np.full(len(sums), REGULARITY.index("regular"), dtype=np.uint8)
        shared = np.zeros_like(weights)
        shared[:, self._common] = weights[:, self._common]
        own_weights = weights - shared
        if shared.any():
            common = self.whole.differentiate(
                slot_indices, values, designs, q, applied, sums, shared, wanted, threads
            )
            by_parameters += common["by_parameters"]
            by_loads += common["by_loads"]
            regularity = np.array(common["regularity"])
        for each in self.components:
            weighed = own_weights[:, each.outputs]
            rows = np.flatnonzero(weighed.any(axis=1))
            if not len(rows):
                continue
            has, own = each.of(slot_indices)
            asked, own_wanted = each.of(wanted)
            visited, of = np.unique(sums[rows], return_inverse=True)
            found = each.engine.differentiate(
                own,
                np.ascontiguousarray(values[:, has]),
                designs[visited],
                np.ascontiguousarray(q[np.ix_(visited, each.coordinates)]),
                np.ascontiguousarray(applied[np.ix_(visited, each.inputs)]),
                of,
                np.ascontiguousarray(weighed[rows]),
                own_wanted,
                threads,
            )
            by_parameters[np.ix_(rows, asked)] += found["by_parameters"]
            by_loads[np.ix_(rows, each.inputs)] += found["by_loads"]
            regularity[rows] = _worst(
                [regularity[rows], found["regularity"]], REGULARITY, _REGULARITY
            )
        return {"by_parameters": by_parameters, "by_loads": by_loads, "regularity": regularity}

    def _together(
        self, found: Sequence[Found], loads: Array, count: int, steps: int
    ) -> dict[str, Any]:
        """Join the arrays of the components."""
        codes = np.stack([each["status"] for each in found])
        status, failing = _status(codes)
        made: dict[str, Any] = {
            "status": status,
            "stability": _worst([each["stability"] for each in found], STABILITY, _STABILITY),
            "friction": found[0]["friction"],
        }
        residuals, tolerances = (
            np.stack([each[name] for each in found]) for name in ("residual", "tolerance")
        )
        share = np.nan_to_num(residuals / tolerances, nan=-1.0)
        share[codes != status] = -2.0
        deciding = share.argmax(axis=0)
        for name, joining in _JOININGS.items():
            rows = [each.rows.get(joining.of, _NO_ROWS) for each in self.components]
            arrays, size = [each[name] for each in found], self._sizes.get(joining.of, 0)
            made[name] = joining.joined(arrays, rows, size, deciding)
        made["free"] = self._free(found)
        given = loads.reshape(len(loads) // steps, steps, loads.shape[-1])
        own = np.broadcast_to(given, (count, steps, loads.shape[-1]))
        made["events"] = self._events(found, made["q"], own)
        for name, joining in _JOININGS.items():
            if joining.without is not None:
                made[name][failing] = joining.without
        return made

    def _free(self, found: Sequence[Found]) -> NDArray[np.intp]:
        rows = []
        for each, component in zip(found, self.components, strict=True):
            own = each["free"].copy()
            own[:, 2] = component.coordinates[own[:, 2]]
            rows.append(own)
        every = np.concatenate(rows)
        return np.asarray(every[np.lexsort((every[:, 2], every[:, 1], every[:, 0]))])

    def _events(self, found: Sequence[Found], q: Array, loads: Array) -> dict[str, Any]:
        """Join events, in the order in which they come along the loads.

        The rest of the model is where it is at the load on the way to which one happens.
        """
        made: dict[str, list[Any]] = {
            name: [] for name in ("design", "step", "kind", "load", "before", "after")
        }
        shares = []
        for each, component in zip(found, self.components, strict=True):
            events = each["events"]
            for k, (design, step) in enumerate(zip(events["design"], events["step"], strict=True)):
                end = loads[design, step]
                begin = loads[design, max(int(step) - 1, 0)]
                range_ = np.abs(end - begin)[component.inputs]
                share = 1.0
                if range_.size and range_.max() > 0.0:
                    most = int(range_.argmax())
                    place = component.inputs[most]
                    share = (events["load"][k, most] - begin[place]) / (end[place] - begin[place])
                load = begin + share * (end - begin)
                load[component.inputs] = events["load"][k]
                states = []
                for name in ("before", "after"):
                    state = q[design, step].copy()
                    state[component.coordinates] = events[name][k]
                    states.append(state)
                shares.append((int(design), int(step), float(share)))
                row = (design, step, events["kind"][k], load, *states)
                for values, value in zip(made.values(), row, strict=True):
                    values.append(value)
        order = sorted(range(len(shares)), key=shares.__getitem__)
        first = found[0]["events"]
        joined: dict[str, Any] = {
            name: np.array([made[name][i] for i in order], dtype=first[name].dtype)
            for name in ("design", "step", "kind")
        }
        widths = {"load": loads.shape[-1], "before": q.shape[-1], "after": q.shape[-1]}
        for name, width in widths.items():
            joined[name] = np.array([made[name][i] for i in order]).reshape(len(order), width)
        return joined


def _component(
    described: Mapping[str, Any], whole: _engine.Model, description: Mapping[str, Any]
) -> _Component:
    text = json.dumps(described, sort_keys=True, separators=(",", ":"))
    engine = _engine.Model(text)
    own, every = _kinds(engine, described), _kinds(whole, description)
    rows = {kind: _places(names, every[kind]) for kind, names in own.items()}
    slots = np.full(len(engine.parameters), -1, dtype=np.intp)
    weightless = _weightless(described, description)
    for name, (start, stop) in engine.slots.items():
        if name not in weightless:
            first, last = whole.slots[name]
            slots[start:stop] = np.arange(first, last)
    return _Component(
        engine=engine,
        plane=in_plane(described, engine),
        slots=slots,
        rows=rows,
        outputs=_outputs(engine, whole, rows, described, description),
    )


def _outputs(
    engine: _engine.Model,
    whole: _engine.Model,
    rows: Mapping[str, Indices],
    described: Mapping[str, Any],
    description: Mapping[str, Any],
) -> Indices:
    """Return the whole model's output of each output of a component."""
    by_name = {
        "joints": _places(_joints(engine), _joints(whole)),
        "rod_bending": rows["rods"],
        "applied": _places(engine.inputs, whole.inputs),
    }
    lists = {
        "springs": "springs",
        "loops": "loops",
        "obstacles": "obstacles",
        "volume": "pressures",
        "ties": "ties",
        "tendon_lengths": "tendons",
        "tendon_tensions": "tendons",
    }
    for group, table in lists.items():
        by_name[group] = _places(_names(described, table), _names(description, table))
    found = np.zeros(_count(engine.outputs), dtype=np.intp)
    for group, (start, stop) in engine.outputs.items():
        first, last = whole.outputs[group]
        if group in _COMMON:
            found[start:stop] = np.arange(first, last)
            continue
        places = by_name[group]
        if len(places):
            each = (stop - start) // len(places)
            found[start:stop] = (first + each * places[:, None] + np.arange(each)).ravel()
    return found


def _kinds(engine: _engine.Model, description: Mapping[str, Any]) -> dict[str, Sequence[str]]:
    """Return the names of what results have rows for, by kind; see `flexor.model.joining`."""
    bodies = description["bodies"]
    found: dict[str, Sequence[str]] = {
        "coordinates": engine.coordinates,
        "inputs": engine.inputs,
        "rods": [body["name"] for body in bodies if "rod" in body["shape"]],
    }
    for kind in _KINDS - found.keys():
        found[kind] = _names(description, kind)
    return found


def _joints(engine: _engine.Model) -> list[str]:
    return [joint["name"] for joint in engine.joints]


def _names(description: Mapping[str, Any], table: str) -> list[str]:
    return [entry["name"] for entry in description.get(table, ())]


def _weightless(described: Mapping[str, Any], description: Mapping[str, Any]) -> set[str]:
    """Return the densities that are not those of the whole model; see `components`."""
    of = {body["name"]: body["shape"] for body in description["bodies"]}
    return {
        f"{body['name']}.density"
        for body in described["bodies"]
        if "link" in body["shape"]
        and body["shape"]["link"]["density"] != of[body["name"]]["link"]["density"]
    }


def _places(names: Sequence[str], every: Sequence[str]) -> Indices:
    place = {name: index for index, name in enumerate(every)}
    return np.array([place[name] for name in names], dtype=np.intp)


def _count(outputs: Mapping[str, tuple[int, int]]) -> int:
    return max(stop for _, stop in outputs.values())


def _status(codes: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """Return the status of the whole, (n, s), of those of k components, and where it failed.

    That of the first component that failed, rather than of one that was not followed further.
    """
    failed = ~np.isin(codes, _EQUILIBRIA)
    weight = np.where(failed & (codes != _NOT_REACHED), 3, np.where(failed, 2, codes != 0))
    first = weight.argmax(axis=0)[None]
    return np.take_along_axis(codes, first, axis=0)[0], np.asarray(failed.any(axis=0))


def _worst(
    codes: Sequence[NDArray[Any]], names: Sequence[str], order: Sequence[str]
) -> NDArray[Any]:
    """Return the worst of several codes of names; those that are not ordered are the best."""
    rank = np.array([order.index(name) if name in order else len(order) for name in names])
    stacked = np.stack(codes)
    worst = rank[stacked].argmin(axis=0)[None]
    return np.asarray(np.take_along_axis(stacked, worst, axis=0)[0])


def _distinct(varied: Array) -> Indices | None:
    """Return which of the distinct designs each is, in the order of their first; None if all are.

    The designs are (n, k) values.
    """
    places: dict[bytes, int] = {}
    of = [places.setdefault(row.tobytes(), len(places)) for row in varied]
    return None if len(places) == len(varied) else np.array(of, dtype=np.intp)


def _taken(found: Found, of: Indices) -> dict[str, Any]:
    """Return the results of designs that are some of those that were followed."""

    def of_each(designs: NDArray[Any]) -> tuple[Indices, NDArray[Any]]:
        """Return which rows belong to the designs, and the design of each."""
        rows = [np.flatnonzero(designs == design) for design in of]
        own = np.repeat(np.arange(len(of)), [len(each) for each in rows])
        return np.concatenate(rows), own.astype(designs.dtype)

    made: dict[str, Any] = {}
    for name, array in found.items():
        if name == "events":
            rows, designs = of_each(array["design"])
            made[name] = {key: value[rows] for key, value in array.items()} | {"design": designs}
        elif name == "free":
            rows, designs = of_each(array[:, 0])
            made[name] = np.column_stack([designs, array[rows, 1:]])
        elif name == "friction":  # without rows
            made[name] = array
        else:
            made[name] = array[of]
    return made
