"""Where a cluster is, as people write it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from flexor.errors import InputError

# More processes than this on one machine are a slip of the finger.
MOST_LOCAL = 1024
_REMOTE = re.compile(
    r"(?P<protocol>[a-z]+)://(?P<host>\[[0-9A-Fa-f:.]+\]|[\w.-]+):(?P<port>[0-9]{1,5})/?",
    re.ASCII,
)
_PROTOCOLS = ("tcp", "tls", "ws", "wss")


@dataclass(frozen=True)
class Address:
    """Where a cluster is.

    Attributes
    ----------
    text : str
        As it was written.
    local : int
        Workers to start on this machine; 0 for a cluster that is running.
    """

    text: str
    local: int = 0

    @classmethod
    def read(cls, text: str) -> Address:
        """Read ``tcp://HOST:PORT`` (or tls, ws, wss) or ``local:N``.

        Raises
        ------
        InputError
            If it is neither.
        """
        text = text.strip()
        kind, _, rest = text.partition(":")
        if kind == "local" and not rest.startswith("//"):
            count = int(rest) if re.fullmatch(r"[0-9]{1,6}", rest, re.ASCII) else -1
            if not 1 <= count <= MOST_LOCAL:
                raise InputError(
                    f'the cluster "{text}" cannot be started: after "local:" belongs the number of '
                    f'workers, from 1 to {MOST_LOCAL}, such as "local:4".'
                )
            return cls(text, count)
        match = _REMOTE.fullmatch(text)
        if match is None or match["protocol"] not in _PROTOCOLS:
            raise InputError(
                f'the cluster "{text}" is not an address: give that of a Dask scheduler, such as '
                '"tcp://HOST:8786", or "local:N" for N workers on this machine.'
            )
        if not 1 <= int(match["port"]) <= 65535:
            raise InputError(
                f'the cluster "{text}" has port {match["port"]}: ports are from 1 to 65535.'
            )
        return cls(text)
