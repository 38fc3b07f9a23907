"""Design variables through a function of the user, from a few parameters to fields."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexor.arguments import check_callable
from flexor.arrays import Array
from flexor.design.custom import STEP
from flexor.design.load_variables import load_variable
from flexor.design.parameter_set import UNITS
from flexor.design.profiles import control_points
from flexor.design.stated_variables import variables_in_si
from flexor.design.variables import NAME, Variables
from flexor.errors import InputError
from flexor.model.geometry import SlotValues
from flexor.model.quantity import infer_quantity

if TYPE_CHECKING:
    from flexor.model import Model
    from flexor.model.structure import Structure

# A function of one design (k,), or of that and of points X (m,).
FieldFunction = Callable[..., Any]
Given = Mapping[str, FieldFunction | tuple[FieldFunction, str]]
_OFFSETS = {-2.0: 1.0 / 12.0, -1.0: -8.0 / 12.0, 1.0: 8.0 / 12.0, 2.0: -1.0 / 12.0}


@dataclass(frozen=True, eq=False)
class MappedVariables(Variables):
    """Design parameters of which fields of a model file are functions; made by `mapped`.

    Attributes
    ----------
    inner : Variables
        The fields.
    functions : tuple of callable
        From a design (k,) to their values, one after the other.
    """

    inner: Variables | None = None
    functions: tuple[Callable[[Array], Array], ...] = ()

    def prepared(self, model: Model) -> Model:
        """Return the model that the designs are of; see `Variables.prepared`."""
        return self._inner.prepared(model)

    @property
    def fields(self) -> tuple[str, ...]:
        """Fields of the model file that the designs change."""
        return self._inner.labels

    def field_values(self, p: Array) -> Array:
        """Return the values of these of n designs (n, k), (n, m), SI."""
        return np.stack([self._of(design) for design in self._designs(p)])

    def designs(self, p: Array, model: Structure) -> tuple[SlotValues, NDArray[np.bool_]]:
        """Return the engine's parameters of designs; see `ParameterSet.designs`."""
        x = self.field_values(p)
        valid = np.isfinite(x).all(axis=1)
        if sizes := [i for i, label in enumerate(self.fields) if ".spline." in label]:
            valid &= (x[:, sizes] > 0.0).all(axis=1)
        found, _ = self._inner.designs(x[valid], model)
        return found, np.asarray(valid)

    def slots(self, model: Structure) -> NDArray[np.intp]:
        """Return which of the engine's parameters the designs change; see `ParameterSet.slots`."""
        return self._inner.slots(model)

    def slot_jacobian(self, p: Array, model: Structure) -> Array:
        """Differentiate the engine's parameters that `designs` changes, (n, m, k)."""
        p = self._designs(p)
        by_fields = self._inner.slot_jacobian(self.field_values(p), model)
        return np.stack(
            [rows @ self._slopes(design) for rows, design in zip(by_fields, p, strict=True)]
        )

    def changes(self, p: Array) -> dict[str, object]:
        """Return one design (k,) as changes of the model file, for `flexor.load`."""
        return self._inner.changes(self.field_values(p)[0])

    @property
    def _inner(self) -> Variables:
        assert self.inner is not None
        return self.inner

    def _of(self, design: Array) -> Array:
        return np.concatenate([function(design) for function in self.functions])

    def _slopes(self, design: Array) -> Array:
        """Differentiate the fields by the parameters, (m, k), by fourth-order differences."""
        slopes = np.zeros((self._inner.size, self.size))
        for i, span in enumerate((self.upper - self.lower).tolist()):
            for offset, weight in _OFFSETS.items():
                moved = design.copy()
                moved[i] += offset * STEP * span
                slopes[:, i] += weight / (STEP * span) * self._of(moved)
        return slopes


def mapped(
    name: str,
    labels: Sequence[str],
    lower: ArrayLike,
    upper: ArrayLike,
    start: ArrayLike,
    fields: Given,
    model: Model,
    *,
    units: Sequence[str] | None = None,
) -> MappedVariables:
    """Make design variables of which fields of a model file are functions.

    Parameters
    ----------
    name : str
        Name of the set.
    labels : sequence of k str
        Names of the parameters.
    lower, upper, start : (k,) array
        Bounds and starting design, SI.
    fields : dict
        A function of one design (k,) for each field, which returns its value, SI. Of a size that
        varies along a rod, a function with the number of control values of its spline,
        ``{"exosuit.section.wall": (wall, "spline 8")}``: ``wall(p, X)`` returns the control values
        at the points X (8,) in [0, 1] where they act, which the spline follows and between whose
        smallest and largest it stays.
    model : Model
        The model.
    units : sequence of k str, optional
        Display units: "1", "m", "cm", "mm", "rad" or "deg". Default "1".

    Returns
    -------
    MappedVariables
        For `flexor.optimize`. Derivatives by the parameters are fourth-order central differences of
        the functions, and exact beyond.

    Raises
    ------
    InputError
        If a field cannot be varied, labels, bounds and start are inconsistent, or a function does
        not return finite numbers, or the same whatever the parameters are.

    Examples
    --------
    >>> import flexor
    >>> model = flexor.load("pneumatic-finger")
    >>> bulge = lambda p, X: p[0] + p[1] * X * (1.0 - X)
    >>> varied = flexor.design.mapped(
    ...     "bulge", ["ends", "rise"], [1.5e-3, 0.0], [2e-3, 3e-3], [2e-3, 0.0],
    ...     {"exosuit.section.wall": (bulge, "spline 6")}, model,
    ... )
    >>> varied.size
    2
    """
    if name == NAME:
        raise InputError(f'parameter set name "{name}" is that of fields: choose another one.')
    if not fields:
        raise InputError(f"parameter set {name}: give a function for at least one field.")
    low, high = np.asarray(lower, dtype=np.float64), np.asarray(upper, dtype=np.float64)
    first = np.asarray(start, dtype=np.float64)
    shown = tuple(units) if units is not None else ("1",) * len(labels)
    for unit in shown:
        if unit not in UNITS:
            raise InputError(
                f"parameter set {name}: unit {unit!r}: expected one of {', '.join(UNITS)}."
            )
    kinds = tuple(infer_quantity(1.0 if unit == "1" else f"1 {unit}", name)[1] for unit in shown)
    functions = []
    for label, given in fields.items():
        if load_variable(label, model) is not None:
            raise InputError(f'parameter set {name}: "{label}" is a load, which has no function.')
        function, profile = given if isinstance(given, tuple) else (given, None)
        check_callable(f'the function of "{label}"', function)
        functions.append(_Checked(label, function, None if profile is None else str(profile)))
    points = low + _unit_points(len(labels)) * (high - low)
    values = np.stack([np.concatenate([each(p) for each in functions]) for p in points])
    inner = _inner(name, functions, values, model)
    return MappedVariables(
        name=name,
        labels=tuple(labels),
        units=shown,
        lower=low,
        upper=high,
        start=first,
        kinds=kinds,
        inner=inner,
        functions=tuple(functions),
    )


@dataclass(frozen=True)
class _Checked:
    """The function of a field, with the points where it is asked if it varies along a rod."""

    label: str
    function: FieldFunction
    profile: str | None

    @property
    def points(self) -> Array | None:
        return None if self.profile is None else control_points(self.profile, self.label)

    def __call__(self, design: Array) -> Array:
        at = self.points
        found = self.function(design.copy()) if at is None else self.function(design.copy(), at)
        if np.iscomplexobj(found):
            raise InputError(f'the function of "{self.label}" returned complex numbers.')
        values = np.atleast_1d(np.asarray(found, dtype=np.float64))
        expected = (1,) if at is None else at.shape
        if values.shape != expected:
            raise InputError(
                f'the function of "{self.label}" must return '
                f"{'a number' if at is None else f'an array of shape {expected}'}, "
                f"got an array of shape {np.shape(found)}."
            )
        return values


def _inner(name: str, functions: Sequence[_Checked], values: Array, model: Model) -> Variables:
    """Return the fields, with the range of their values as bounds."""
    if not np.isfinite(values).all():
        raise InputError(f"parameter set {name}: a function does not return finite numbers.")
    bounds: dict[str, tuple[object, ...]] = {}
    column = 0
    for each in functions:
        count = 1 if each.points is None else len(each.points)
        mine = values[:, column : column + count]
        column += count
        low, high = float(mine.min()), float(mine.max())
        if not low < high:
            raise InputError(f'parameter set {name}: "{each.label}" depends on no parameter.')
        if each.profile is not None and low <= 0.0:
            raise InputError(
                f'parameter set {name}: "{each.label}" is {low:g} m for some parameters: a size '
                "has to be above 0 within the bounds."
            )
        bounds[each.label] = (low, high) if each.profile is None else (low, high, each.profile)
    return variables_in_si(bounds, model, f"parameter set {name}")


def _unit_points(k: int) -> Array:
    """Return points all over [0, 1]^k, (c, k): its middle, vertices as far as few, and others."""
    from scipy.stats import qmc  # deferred: slow to import

    inside = qmc.Sobol(k, scramble=True, seed=0).random(64)
    corners = (
        np.array(np.meshgrid(*[[0.0, 1.0]] * k)).reshape(k, -1).T if k <= 6 else inside.round()
    )
    return np.concatenate([np.full((1, k), 0.5), corners, inside])
