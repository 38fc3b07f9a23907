"""Parameter sets: named, bounded design parameters and their map to geometry."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexor.arrays import Array
from flexor.design.profile import Fixed, Profile
from flexor.design.start import parse_value
from flexor.errors import InputError, unknown
from flexor.model.geometry import PAPER, DesignSpace, Geometry, GeometryJacobian, SlotValues

if TYPE_CHECKING:
    from flexor.model.structure import Structure

# Display units of design parameters, in SI.
UNITS = {"1": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001, "rad": 1.0, "deg": np.pi / 180.0}


@dataclass(frozen=True, eq=False)
class ParameterSet:
    """Design parameters p in R^k and the map p -> geometry of the exosuit.

    A set changes the length, the surface, or both; anything else is taken from the rod.

    Attributes
    ----------
    name : str
        Name on the command line, for example ``"L+R01"``.
    labels : tuple of k str
        For example ``("L", "R_0", "R_1")``.
    units : tuple of k str
        Units for display (keys of ``UNITS``); everything stored is SI.
    lower, upper, start : (k,) arrays
        Bounds and starting design, SI.
    length_column : int or None
        Index of the length L; None if the set does not change the length.
    profile : Profile or None
        Surface S(X; p); None if the set does not change the surface.
    rod : DesignSpace
        The exosuit that supplies the length or the surface if the set does not change it.
    """

    name: str
    labels: tuple[str, ...]
    units: tuple[str, ...]
    lower: Array
    upper: Array
    start: Array
    length_column: int | None = None
    profile: Profile | None = None
    rod: DesignSpace = PAPER

    def __post_init__(self) -> None:
        """Raise InputError if numbers differ, labels repeat, or bounds are not in order."""
        count = len(self.labels)
        for field in ("lower", "upper", "start"):
            values = np.array(getattr(self, field), dtype=np.float64)
            values.setflags(write=False)
            object.__setattr__(self, field, values)
            if values.shape != (count,):
                raise InputError(
                    f"parameter set {self.name}: {field} has shape {values.shape}, "
                    f"but there are {count} labels."
                )
            if not np.all(np.isfinite(values)):
                raise InputError(f"parameter set {self.name}: {field} must be finite numbers.")
        if len(self.units) != count:
            raise InputError(
                f"parameter set {self.name}: {len(self.units)} units for {count} labels."
            )
        self._check_units()
        if len(set(self.labels)) != count:
            raise InputError(f"parameter set {self.name}: a label appears twice in {self.labels}.")
        for label, low, high in zip(self.labels, self.lower, self.upper, strict=True):
            if not low < high:
                raise InputError(
                    f"parameter set {self.name}: the lower bound of {label}, {low:g}, "
                    f"is not below its upper bound, {high:g}."
                )

    def _check_units(self) -> None:
        for unit in self.units:
            if unit not in UNITS:
                raise unknown("unit", unit, UNITS)

    @property
    def size(self) -> int:
        """Number k of parameters."""
        return len(self.labels)

    @property
    def scale(self) -> Array:
        """SI value of one display unit of each parameter, (k,)."""
        return np.array([UNITS[unit] for unit in self.units])

    @property
    def si_units(self) -> tuple[str, ...]:
        """SI unit of each parameter, ``"1"`` for plain numbers."""
        return tuple({"cm": "m", "mm": "m", "deg": "rad"}.get(unit, unit) for unit in self.units)

    def parse(self, label: str, text: str, option: str) -> float:
        """Read the value of a parameter, SI; InputError, beginning with ``option``, if none."""
        return parse_value(text, label, self.units[self.labels.index(label)], option)

    def geometry(self, p: ArrayLike, X: ArrayLike) -> Geometry:
        """Compute the geometry of n designs at m points.

        Parameters
        ----------
        p : (n, k) array
            Designs, SI.
        X : (m,) array
            Points in [0, 1], fractions of the length.

        Returns
        -------
        Geometry
            Length (n,), radius (n, m) and slope (n, m).

        Raises
        ------
        InputError
            If ``p`` does not have k columns.
        """
        p, X = self._designs(p), np.asarray(X, dtype=np.float64)
        if self.length_column is None:
            length = np.full(p.shape[0], self.rod.length)
        else:
            length = p[:, self.length_column].copy()
        radius, slope = self._surface.value(p, X)
        return Geometry(length, radius, slope)

    def jacobian(self, p: ArrayLike, X: ArrayLike) -> GeometryJacobian:
        """Differentiate `geometry` with respect to the parameters.

        InputError if ``p`` does not have k columns.
        """
        p, X = self._designs(p), np.asarray(X, dtype=np.float64)
        length = np.zeros(p.shape)
        if self.length_column is not None:
            length[:, self.length_column] = 1.0
        radius, slope = self._surface.jacobian(p, X)
        return GeometryJacobian(length, radius, slope)

    def designs(
        self, p: Array, model: Structure
    ) -> tuple[Geometry | SlotValues, NDArray[np.bool_]]:
        """Return what a model is to be evaluated for, and which of n designs can be, (n,).

        Parameters
        ----------
        p : (n, k) array
            Designs, SI.
        model : Model
            The model.

        Returns
        -------
        designs : Geometry or SlotValues
            Of those that can be evaluated.
        valid : (n,) array
            Which these are.
        """
        geometry = self.geometry(p, model.design.points)
        valid = np.isfinite(geometry.length) & (geometry.length > 0.0)
        valid &= np.all(np.isfinite(geometry.radius) & (geometry.radius > 0.0), axis=1)
        valid &= np.all(np.isfinite(geometry.slope), axis=1)
        chosen = (geometry.length[valid], geometry.radius[valid], geometry.slope[valid])
        return Geometry(*chosen), valid

    @property
    def varied_inputs(self) -> tuple[str, ...]:
        """Inputs whose loads depend on the design."""
        return ()

    def own_loads(self, p: Array, loads: Array, model: Structure) -> Array | None:
        """Return the loads (n, s, u) of n designs, given those of all, (s, u); None if the same."""
        return None

    def load_jacobian(self, loads: Array, model: Structure) -> Array | None:
        """Differentiate these by the parameters, (s, u, k); None if they do not depend on them."""
        return None

    def slots(self, model: Structure) -> NDArray[np.intp]:
        """Return which of the engine's parameters the designs change, (m,)."""
        return model.geometry_indices

    def slot_jacobian(self, p: Array, model: Structure) -> Array:
        """Differentiate these of n designs by the parameters, (n, m, k)."""
        return model.geometry_slot_jacobian(self.jacobian(p, model.design.points))

    def on(self, rod: DesignSpace) -> ParameterSet:
        """Return the same set for another exosuit."""
        return replace(self, rod=rod)

    def on_model(self, model: Structure) -> ParameterSet:
        """Return the same set for the exosuit that a model's ``[design]`` names.

        InputError if it names none and the set is of an exosuit.
        """
        return self.on(model.design)

    def with_bounds(self, bounds: Mapping[str, tuple[float, float]]) -> ParameterSet:
        """Return the set with other bounds, given per label in SI.

        InputError if a label is unknown or a lower bound is not below the upper one.
        """
        lower, upper = self.lower.copy(), self.upper.copy()
        for label, (low, high) in bounds.items():
            if label not in self.labels:
                raise unknown(f"parameter of the set {self.name}", label, self.labels)
            lower[self.labels.index(label)], upper[self.labels.index(label)] = low, high
        return replace(self, lower=lower, upper=upper)

    def with_start(self, start: ArrayLike) -> ParameterSet:
        """Return the set with another starting design (k,), SI."""
        return replace(self, start=np.asarray(start, dtype=np.float64))

    def check_inside(self, p: ArrayLike, what: str = "start") -> None:
        """Raise InputError if one of the designs, (k,) or (n, k), SI, is outside the bounds.

        It says ``what`` the design is, the first parameter out of bounds, and its bounds.
        """
        designs = self._designs(p)
        for design in designs:
            for i, value in enumerate(design):
                if not self.lower[i] <= value <= self.upper[i]:
                    scale, unit = self.scale[i], self.units[i]
                    suffix = "" if unit == "1" else f" {unit}"
                    raise InputError(
                        f"{what} of {self.name}: {self.labels[i]} = {value / scale:g}{suffix} is "
                        f"outside its bounds {self.lower[i] / scale:g} to "
                        f"{self.upper[i] / scale:g}{suffix}."
                    )

    @property
    def _surface(self) -> Profile:
        return self.profile or Fixed(self.rod.radius_base, self.rod.radius_tip)

    def _designs(self, p: ArrayLike) -> Array:
        designs: Array = np.atleast_2d(np.asarray(p, dtype=np.float64))
        if designs.ndim != 2 or designs.shape[1] != self.size:
            raise InputError(
                f"parameter set {self.name} has {self.size} parameters "
                f"({', '.join(self.labels)}), got an array of shape {np.shape(p)}."
            )
        return designs
