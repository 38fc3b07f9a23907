"""A material: a constitutive law with its constants, how it is wound, and its limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from flexor.arrays import Array
from flexor.display import Displayed
from flexor.errors import InputError, unknown
from flexor.materials import laws

Constant = float | tuple[float, ...]

# Constants of each kind [Pa; Poisson's ratio and the exponents α are numbers], and their defaults.
KINDS: dict[str, dict[str, Constant | None]] = {
    "linear": {"young_modulus": None, "poisson_ratio": 0.5},
    "neo-hookean": {"shear_modulus": None},
    "mooney-rivlin": {"c10": None, "c01": None},
    "yeoh": {"c1": None, "c2": 0.0, "c3": 0.0},
    "ogden": {"mu": None, "alpha": None},
}
WINDINGS = ("none", "hoop")


@dataclass(frozen=True)
class Material(Displayed):
    """A constitutive law with its constants.

    Parameters
    ----------
    name
        For messages.
    kind
        One of `KINDS`; see `flexor.materials.laws` for the energies.
    constants
        By name, as in `KINDS` [Pa]; ``mu`` [Pa] and ``alpha`` of Ogden's law are tuples of the same
        length, with the energy Σ μ_i/α_i I(α_i).
    winding
        ``"hoop"`` if the hoop stretch is kept at 1, ``"none"`` otherwise.
    density
        [kg/m³].
    strain_limit, stress_limit
        Largest nominal strain, and largest nominal stress [Pa], that the material should see; none
        by default.
    stretch_range
        Stretches between which the constants were measured; unknown by default.
    title, source
        Of the material and of its constants.

    Raises
    ------
    InputError
        If the kind, the winding or a constant is invalid, or the material is not stiff at rest.
    """

    name: str
    kind: str
    constants: Mapping[str, Constant]
    winding: str = "none"
    density: float = 0.0
    strain_limit: float = math.inf
    stress_limit: float = math.inf
    stretch_range: tuple[float, float] | None = None
    title: str = field(default="", compare=False)
    source: str = field(default="", compare=False)

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise unknown(f"kind of the {self._called}", str(self.kind), KINDS)
        if self.winding not in WINDINGS:
            raise unknown(f"winding of the {self._called}", str(self.winding), WINDINGS)
        allowed = KINDS[self.kind]
        for key in self.constants:
            if key not in allowed:
                raise unknown(f"constant of the {self.kind} {self._called}", key, allowed)
        for key, default in allowed.items():
            if key not in self.constants and default is None:
                raise InputError(f"the {self.kind} {self._called} needs {key}.")
        if self.kind == "ogden" and np.shape(self["mu"]) != np.shape(self["alpha"]):
            raise InputError(f"mu and alpha of the {self._called} differ in length.")
        if not -1.0 < self.poisson_ratio <= 0.5:
            raise InputError(
                f"poisson_ratio of the {self._called} is {self.poisson_ratio:g}: "
                "expected a number above -1 and at most 0.5."
            )
        if not (self.young_modulus > 0.0 and math.isfinite(self.young_modulus)):
            raise InputError(
                f"the {self.kind} {self._called} has a Young's modulus of "
                f"{self.young_modulus:g} Pa at rest: expected a positive number."
            )

    @property
    def _called(self) -> str:
        return f'material "{self.name}"' if self.name else "material"

    def __getitem__(self, constant: str) -> Constant:
        """Return a constant, or its default."""
        value = self.constants.get(constant, KINDS[self.kind][constant])
        assert value is not None
        return value

    def _number(self, constant: str) -> float:
        return float(np.asarray(self[constant], dtype=float))

    @property
    def numbers(self) -> list[float]:
        """The constants in the order of the engine: Ogden's as pairs μ_i, α_i."""
        columns = [np.ravel(self[key]) for key in KINDS[self.kind]]
        return [float(x) for x in np.stack(columns, axis=1).ravel()]

    @property
    def poisson_ratio(self) -> float:
        """Poisson's ratio ν at small strain."""
        return self._number("poisson_ratio") if self.kind == "linear" else 0.5

    @property
    def young_modulus(self) -> float:
        """Young's modulus E of the unwound material at small strain [Pa]."""
        c = self.numbers
        if self.kind == "linear":
            return c[0]
        shear = {
            "neo-hookean": c[0],
            "mooney-rivlin": 2.0 * sum(c),
            "yeoh": 2.0 * c[0],
            "ogden": 0.5 * sum(mu * alpha for mu, alpha in zip(c[::2], c[1::2], strict=False)),
        }
        return 3.0 * shear[self.kind]

    @property
    def shear_modulus(self) -> float:
        """Shear modulus G = E/(2(1 + ν)) at small strain [Pa]."""
        return self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))

    def energy(self, stretch: ArrayLike) -> laws.Energy:
        """Return the energy of a fibre, free or wound, and its derivatives.

        Parameters
        ----------
        stretch : array_like
            λ, of any shape.

        Returns
        -------
        flexor.materials.laws.Energy
            w [J/m³], w' (the nominal stress) [Pa] and w'' [Pa], of the shape of `stretch`.
        """
        return laws.fibre_energy(self.kind, self.numbers, stretch, self.winding == "hoop")

    def nominal_stress(self, stretch: ArrayLike) -> Array:
        """Return the force per unstrained area, w'(λ) [Pa]; see `energy`."""
        return self.energy(stretch).first

    def true_stress(self, stretch: ArrayLike) -> Array:
        """Return the force per strained area of an incompressible fibre, λ w'(λ) [Pa]."""
        return np.asarray(stretch, dtype=float) * self.nominal_stress(stretch)
