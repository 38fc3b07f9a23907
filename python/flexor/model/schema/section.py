"""Cross-sections of rods: solid, hollow, composed of parts, or given by their stiffness."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from flexor.model import units
from flexor.model.schema.profile import Samples, Spline, is_spline
from flexor.model.schema.table import (
    Choice,
    Name,
    Number,
    PositiveNumber,
    Table,
    Text,
    one_of,
)
from flexor.model.units import (
    AxialStiffness,
    BendingStiffness,
    CoupledStiffness,
    Length,
    LineDensity,
    PositiveLength,
)
from flexor.model.validation import field_error

SOLID = ("circular", "elliptic", "rectangular")
KINDS = (*SOLID, "tube", "half-round", "box", "composite", "stiffness")


def _form(value: object) -> str:
    if is_spline(value):
        return "spline"
    if isinstance(value, (list, tuple)):
        return "samples"
    # A length keeps its text and so is not a plain number.
    plain = isinstance(value, (int, float)) and not hasattr(value, "text")
    return "multiple" if plain else "length"


Size = Annotated[
    Annotated[PositiveLength, Tag("length")]
    | Annotated[PositiveNumber, Tag("multiple")]
    | Annotated[Samples, Tag("samples")]
    | Annotated[Spline, Tag("spline")],
    Discriminator(_form),
]
Offset = Annotated[
    Annotated[Length, Tag("length")] | Annotated[Number, Tag("multiple")], Discriminator(_form)
]
WindingPlace = Annotated[Literal["outside", "inside"], Choice("outside", "inside")]


Fraction = Annotated[Number, Field(ge=0.0, le=1.0)]


class Piece(Table):
    """Base class of sections: the span of a rod that has the section."""

    span: tuple[Fraction, Fraction] | None = None


class Solid(Piece):
    """A solid shape with half-height S along z and half-width ratio S along y."""

    kind: Literal["circular", "elliptic", "rectangular"]
    ratio: PositiveNumber | None = None

    @model_validator(mode="after")
    def _check(self) -> Solid:
        if self.kind == "circular" and self.ratio is not None:
            raise field_error(f"is {self.ratio!r}: circular sections do not have it", path="ratio")
        if self.kind != "circular" and self.ratio is None:
            raise field_error(
                f"is missing: {self.kind} sections need it (half-width over half-height)",
                path="ratio",
            )
        return self


class Layer(Table):
    """A layer at the bottom of a floor, usually one that limits strain."""

    thickness: Size
    material: Name
    stretch: PositiveNumber = 1.0


class Hollow(Piece):
    """Base class of sections with one cavity."""

    wall: Size
    material: Name | None = None
    winding: WindingPlace = "outside"
    stretch: PositiveNumber = 1.0


class Floored(Hollow):
    """What sections with a floor have in common.

    The floor is held flat across. One that is free to bulge changes the outline of the section,
    which is fixed here: finite elements of such a half-round bend 12 to 46 % less.
    """

    flat_floor: bool = True
    layer: Layer | None = None

    @model_validator(mode="after")
    def _is_flat(self) -> Floored:
        if not self.flat_floor:
            tail = (
                "is false, but a floor that is free to bulge changes the shape of the section and "
                "is not modelled (it bends less: see Finite elements in the documentation); hold "
                "it flat, by ribs or a stiff layer, and set true"
            )
            raise field_error(tail, path="flat_floor")
        return self


class Strip(Layer):
    """A layer of a given width along the underside of a tube."""

    width: Size


class Tube(Hollow):
    """A tube of outer radius S."""

    kind: Literal["tube"]
    layer: Strip | None = None


class HalfRound(Floored):
    """A half-tube on a flat floor, of height 2S in all; its flat side is below."""

    kind: Literal["half-round"]
    floor: Size


class Box(Floored):
    """A rectangular tube of height 2S and the given width; its sides are held flat."""

    kind: Literal["box"]
    width: Size
    floor: Size | None = None


class Part(Table):
    """A shape of a composite section: of a material, or a cavity.

    Discs and rings have a radius, half-discs and half-rings stand on their flat side; the offset is
    that of their centre. The offset of a rectangle is that of its middle.
    """

    shape: Annotated[
        Literal["disc", "ring", "half-disc", "half-ring", "rectangle"],
        Choice("disc", "ring", "half-disc", "half-ring", "rectangle"),
    ]
    y: Offset = units.LENGTH.si(0.0)
    z: Offset = units.LENGTH.si(0.0)
    radius: Size | None = None
    wall: Size | None = None
    width: Size | None = None
    height: Size | None = None
    material: Name | None = None
    cavity: Text | None = None
    stretch: PositiveNumber = 1.0

    @model_validator(mode="after")
    def _check(self) -> Part:
        needed = {
            "disc": ("radius",),
            "ring": ("radius", "wall"),
            "half-disc": ("radius",),
            "half-ring": ("radius", "wall"),
            "rectangle": ("width", "height"),
        }[self.shape]
        for key in ("radius", "wall", "width", "height"):
            given = getattr(self, key) is not None
            if given and key not in needed:
                raise field_error(f"is given, but a {self.shape} does not have it", path=key)
            if not given and key in needed:
                raise field_error(f"is missing: a {self.shape} needs it", path=key)
        if self.material is not None and self.cavity is not None:
            raise field_error(
                "is given as well as a material: a part is one or the other", "cavity"
            )
        return self


class Composite(Piece):
    """Parts of material and cavities."""

    kind: Literal["composite"]
    parts: Annotated[tuple[Part, ...], Field(min_length=1)]
    torsion_stiffness: BendingStiffness | None = None

    @model_validator(mode="after")
    def _check(self) -> Composite:
        cavities = [part.cavity for part in self.parts if part.cavity is not None]
        for index, part in enumerate(self.parts):
            if part.cavity is not None and cavities.count(part.cavity) > 1:
                tail = f'is "{part.cavity}", as that of another part'
                raise field_error(tail, path=f"parts[{index}].cavity")
        return self


class Stiffness(Piece):
    """Stiffness as a section program prints it, about the axis.

    EA; ES_y = ∫ E z dA, ES_z = ∫ E y dA; EI_yy = ∫ E z² dA, EI_zz = ∫ E y² dA,
    EI_yz = ∫ E y z dA; GJ; GA_y, GA_z. Or the whole symmetric matrix in SI units, in the order
    twist_x, bend_y, bend_z, extend_x, shear_y, shear_z.
    """

    kind: Literal["stiffness"]
    EA: AxialStiffness | None = None
    ES_y: CoupledStiffness | None = None
    ES_z: CoupledStiffness | None = None
    EI_yy: BendingStiffness | None = None
    EI_zz: BendingStiffness | None = None
    EI_yz: BendingStiffness | None = None
    GJ: BendingStiffness | None = None
    GA_y: AxialStiffness | None = None
    GA_z: AxialStiffness | None = None
    matrix: tuple[tuple[Number, ...], ...] | None = None
    mass: LineDensity = units.LINE_DENSITY.si(0.0)

    @model_validator(mode="after")
    def _check(self) -> Stiffness:
        import numpy as np

        if self.matrix is not None:
            given = next((key for key in self._names() if getattr(self, key) is not None), None)
            if given is not None:
                raise field_error("is given as well as the matrix: give one of them", path=given)
            if [len(row) for row in self.matrix] != [6] * 6:
                raise field_error("has another shape: expected 6 rows of 6 numbers", path="matrix")
            full = np.array(self.matrix)
            if not np.allclose(full, full.T, rtol=1e-9, atol=0.0):
                raise field_error("is not symmetric", path="matrix")
        given_as = "EA" if self.matrix is None else "matrix"
        full = np.array(self.full())
        active = np.flatnonzero(np.abs(full).any(axis=0))
        if not len(active):
            raise field_error("has no stiffness: give at least one, or the matrix", path=given_as)
        scale = np.sqrt(np.abs(np.diag(full)[active]))
        block = full[np.ix_(active, active)] / np.outer(scale, scale) if scale.all() else -np.eye(1)
        if np.linalg.eigvalsh(block)[0] <= 0.0:
            tail = "is not positive definite: some motion would release energy"
            raise field_error(tail, given_as)
        return self

    @classmethod
    def _names(cls) -> tuple[str, ...]:
        return tuple(name for name in cls.model_fields if name[0] in "EG")

    def full(self) -> list[list[float]]:
        """Return the 6 × 6 matrix [SI], in the order of the strain modes."""
        if self.matrix is not None:
            return [[float(value) for value in row] for row in self.matrix]
        n = {name: float(getattr(self, name) or 0.0) for name in self._names()}
        zero = [0.0] * 6
        return [
            [n["GJ"], *zero[1:]],
            [0.0, n["EI_yy"], -n["EI_yz"], n["ES_y"], 0.0, 0.0],
            [0.0, -n["EI_yz"], n["EI_zz"], -n["ES_z"], 0.0, 0.0],
            [0.0, n["ES_y"], -n["ES_z"], n["EA"], 0.0, 0.0],
            [*zero[:4], n["GA_y"], 0.0],
            [*zero[:5], n["GA_z"]],
        ]


def _named(value: object) -> object:
    return {"kind": value} if isinstance(value, str) else value


def _kind(value: Any) -> str:
    kind = value.get("kind") if isinstance(value, dict) else getattr(value, "kind", None)
    return "solid" if kind in SOLID else str(kind)


Section = Annotated[
    Annotated[Solid, Tag("solid")]
    | Annotated[Tube, Tag("tube")]
    | Annotated[HalfRound, Tag("half-round")]
    | Annotated[Box, Tag("box")]
    | Annotated[Composite, Tag("composite")]
    | Annotated[Stiffness, Tag("stiffness")],
    Discriminator(_kind),
    BeforeValidator(one_of(*KINDS)),
    BeforeValidator(_named),
]


def _several(value: object) -> str:
    return "pieces" if isinstance(value, (list, tuple)) else "section"


Sections = Annotated[
    Annotated[Section, Tag("section")]
    | Annotated[Annotated[tuple[Section, ...], Field(min_length=1)], Tag("pieces")],
    Discriminator(_several),
]


def materials_of(section: Section) -> list[tuple[str, str | None]]:
    """List the path and the name of each material that a section names; None for the rod's own.

    Parameters
    ----------
    section
        A section.
    """
    if isinstance(section, Composite):
        named = [(f"parts[{i}].material", p) for i, p in enumerate(section.parts)]
        return [(path, part.material) for path, part in named if part.cavity is None]
    if isinstance(section, Hollow):
        layer = getattr(section, "layer", None)
        return [("material", section.material)] + (
            [("layer.material", layer.material)] if layer else []
        )
    return [("material", None)] if isinstance(section, Solid) else []


def cavities_of(section: Section) -> list[str]:
    """List the names of a section's cavities.

    Parameters
    ----------
    section
        A section.
    """
    if isinstance(section, Hollow):
        return ["bore"]
    if isinstance(section, Composite):
        return [part.cavity for part in section.parts if part.cavity is not None]
    return []
