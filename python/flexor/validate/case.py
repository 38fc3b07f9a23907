"""What a validation case is, and what it hands back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module, metadata
from typing import TYPE_CHECKING, Any

from flexor.installing import install_command
from flexor.validate.comparison import Comparison

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Unavailable(Exception):
    """A reference that is not at hand; its text says how to get it."""


@dataclass(frozen=True)
class Library:
    """Another library whose results serve as reference.

    Attributes
    ----------
    module, package : str
        What to import, and what to install for it.
    """

    module: str
    package: str

    def load(self, part: str = "") -> Any:
        """Import it.

        Parameters
        ----------
        part
            A module inside it.

        Raises
        ------
        Unavailable
            If it is not installed.
        """
        try:
            return import_module(f"{self.module}.{part}" if part else self.module)
        except ModuleNotFoundError as error:
            if error.name is None or error.name.split(".")[0] != self.module:
                raise
            raise Unavailable(
                f"{self.package} is missing: {install_command('flexor[validate]')}"
            ) from None

    @property
    def version(self) -> str:
        """Name and version of what is installed."""
        return f"{self.package} {metadata.version(self.package)}"


@dataclass(frozen=True)
class Outcome:
    """What a case found.

    Attributes
    ----------
    comparisons : tuple of Comparison
        At least one.
    draw : callable, optional
        Draws the case into an empty figure.
    caption : str
        What the figure shows.
    panels : int
        How many plots it has side by side.
    """

    comparisons: tuple[Comparison, ...]
    draw: Callable[[Figure], None] | None = None
    caption: str = ""
    panels: int = 1

    @property
    def passed(self) -> bool:
        """Whether every comparison passed."""
        return all(comparison.passed for comparison in self.comparisons)


@dataclass(frozen=True)
class Case:
    """A validation case.

    Attributes
    ----------
    name : str
        What it is called on the command line.
    title : str
        One line about it.
    family : str
        Where the reference comes from, one of `FAMILIES`.
    about : str
        System, reference and its source, as text for the report (Markdown).
    run : callable
        Computes both sides and compares.
    library : Library, optional
        What has to be installed for it.
    """

    name: str
    title: str
    family: str
    about: str
    run: Callable[[], Outcome]
    library: Library | None = None


CLOSED_FORM = "Closed forms"
OTHER_LIBRARY = "Other libraries"
CONVERGENCE = "Convergence"
TOOLBOX = "The toolbox of the paper"
FAMILIES = (CLOSED_FORM, OTHER_LIBRARY, CONVERGENCE, TOOLBOX)
