"""The map from fields of a model file to the engine's parameters, of whatever kind they need."""

from __future__ import annotations

from collections.abc import Sequence

from flexor.arrays import Array
from flexor.design.fields import spline_of
from flexor.design.parts_map import Group, PartsMap, groups_of_fields, regrouped
from flexor.design.refitting import refitted
from flexor.design.slot_map import SlotMap
from flexor.design.slot_search import slot_map
from flexor.design.span_map import SpanMap, is_span
from flexor.design.spline_map import SplineMap, refitted_spline_map, spline_map
from flexor.model.structure import Structure

Keys = tuple[str, ...]
OneMap = SlotMap | SplineMap | SpanMap
FieldMap = OneMap | PartsMap[OneMap]


def field_map(
    model: Structure,
    keys: Sequence[Keys],
    labels: Sequence[str],
    lower: Array,
    upper: Array,
) -> FieldMap:
    """Find how the engine's parameters depend on fields; see `flexor.design.slot_search.slot_map`.

    Those of independent components of the model are found on these alone.
    """
    groups = []
    for fields, part in groups_of_fields(model, keys):
        own, names = [keys[i] for i in fields], [labels[i] for i in fields]
        made = _one_map(part.model, own, names, lower[fields], upper[fields])
        groups.append(Group(fields, part, made))
    joined = PartsMap.of(groups) if groups else None
    return _one_map(model, keys, labels, lower, upper) if joined is None else joined


def field_map_again(
    like: FieldMap, known: Structure, model: Structure, keys: Sequence[Keys]
) -> FieldMap | None:
    """Find the same for another model with other numbers; None if it is made of others."""
    if not isinstance(like, PartsMap):
        return _one_again(like, known, model, keys)
    parts, groups = regrouped(like, model), []
    if parts is None:
        return None
    for group, part in zip(like.groups, parts, strict=True):
        own = [keys[i] for i in group.fields]
        made = _one_again(group.map, group.part.model, part.model, own)
        if made is None:
            return None
        groups.append(Group(group.fields, part, made))
    return PartsMap.of(groups)


def _one_map(
    model: Structure,
    keys: Sequence[Keys],
    labels: Sequence[str],
    lower: Array,
    upper: Array,
) -> OneMap:
    if any(map(is_span, keys)):
        left = [i for i, each in enumerate(keys) if not is_span(each)]
        others, names = [keys[i] for i in left], [labels[i] for i in left]
        found = _one_map(model, others, names, lower[left], upper[left])
        assert not isinstance(found, SpanMap)
        return SpanMap.of(found, model, keys)
    make = spline_map if any(spline_of(each, model.file) for each in keys) else slot_map
    return make(model, keys, labels, lower, upper)


def _one_again(
    like: OneMap, known: Structure, model: Structure, keys: Sequence[Keys]
) -> OneMap | None:
    if isinstance(like, SpanMap):
        others = [each for each in keys if not is_span(each)]
        found = _one_again(like.others, known, model, others) if others else like.others
        return None if found is None else SpanMap.of(found, model, keys)  # type: ignore[arg-type]
    if isinstance(like, SplineMap):
        return refitted_spline_map(like, model, keys)
    return refitted(like, known, model, keys)
