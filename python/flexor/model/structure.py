"""What results know of the model that they come from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from flexor.design.geometry import Geometry, GeometryJacobian

if TYPE_CHECKING:
    from flexor import _engine
    from flexor.model.schema import ModelFile

Array = NDArray[np.float64]


class Structure(Protocol):
    """Names, counts and parameters of a `flexor.model.Model`."""

    file: ModelFile
    engine: _engine.Model

    @property
    def name(self) -> str:
        """Its name."""
        ...

    @property
    def planar(self) -> bool:
        """Whether it lies in the x-z plane."""
        ...

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the load inputs."""
        ...

    def load_unit(self, index: int = 0) -> tuple[float, str]:
        """Return the unit in which loads of an input are shown, in SI and by name."""
        ...

    @property
    def pressures(self) -> tuple[str, ...]:
        """Names of the pressures."""
        ...

    @property
    def rods(self) -> tuple[str, ...]:
        """Names of the rods."""
        ...

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints' coordinates."""
        ...

    @property
    def joint_columns(self) -> NDArray[np.intp]:
        """Which coordinates belong to joints, (joints,)."""
        ...

    @property
    def angular_joints(self) -> tuple[str, ...]:
        """Names of those that are angles."""
        ...

    @property
    def body_frames(self) -> Mapping[str, tuple[int, int]]:
        """Range of each body's frames among the engine's."""
        ...

    @property
    def sphere_groups(self) -> Mapping[str, int]:
        """Number of spheres of each group."""
        ...

    @property
    def first_spheres(self) -> int:
        """Number of spheres of the contacts' first groups."""
        ...

    @property
    def parameters(self) -> Array:
        """The engine's parameters, (P,)."""
        ...

    def slot(self, name: str, parameters: Array | None = None) -> Array:
        """Return parameters of the engine by name."""
        ...

    def geometry_slots(self, geometry: Geometry) -> tuple[NDArray[np.intp], Array]:
        """Place the designed geometry among the engine's parameters: indices and values."""
        ...

    def geometry_slot_jacobian(self, jacobian: GeometryJacobian) -> Array:
        """Differentiate the parameters of the designed geometry."""
        ...
