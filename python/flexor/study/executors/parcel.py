"""What is sent to workers: a problem, once; and work on it, function and arguments."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

from flexor.errors import InputError
from flexor.study.problem import Problem


@dataclass(frozen=True)
class Parcel:
    """A problem on its way to workers.

    Attributes
    ----------
    token : str
        What work on it calls it by.
    version : str
        Of the Flexor that sends it.
    content : bytes
        The problem, pickled: its model as the text of a model file, functions of a user's own by
        value where they have no module.
    """

    token: str
    version: str
    content: bytes

    @classmethod
    def of(cls, problem: Problem) -> Parcel:
        """Pack a problem.

        Raises
        ------
        InputError
            If its parameter set or its objective cannot be sent.
        """
        import cloudpickle

        try:
            content: bytes = cloudpickle.dumps(problem, protocol=5)
        except Exception as error:
            raise InputError(
                f'parameter set "{problem.parameters.name}" or objective '
                f'"{problem.objective.name}" cannot be sent to a cluster: '
                f"{' '.join(str(error).split()).rstrip('.')}."
            ) from error
        return cls(hashlib.sha256(content).hexdigest()[:16], version("flexor"), content)


def packed(function: Callable[..., Any], *arguments: Any) -> bytes:
    """Pack work.

    Parameters
    ----------
    function : callable
        From a problem and the arguments to a result.
    *arguments
        The arguments.
    """
    import cloudpickle

    work: bytes = cloudpickle.dumps((function, arguments), protocol=5)
    return work
