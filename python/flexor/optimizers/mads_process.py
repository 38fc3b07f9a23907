"""Subprocess that runs NOMAD: it requests blocks of designs and receives their values.

NOMAD keeps its random state between runs, handles Ctrl-C itself and cannot be stopped from a
callback, so each run has its own process. The protocol is one JSON document per line: the
parameters on stdin; then points on stdout and their values (null for a failure) on stdin, in
turns; finally the stop reason on stdout.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any


def main() -> None:
    """Run NOMAD once."""
    import signal

    import PyNomad

    # NOMAD prints warnings to stdout, which carries the protocol. The parent handles Ctrl-C.
    out = os.fdopen(os.dup(1), "w", encoding="ascii")
    os.dup2(2, 1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def send(message: dict[str, Any]) -> None:
        out.write(json.dumps(message) + "\n")
        out.flush()

    def evaluate_block(block: Any) -> list[bool]:
        points = [block.get_x(i) for i in range(block.size())]
        send({"points": [[point.get_coord(j) for j in range(point.size())] for point in points]})
        line = sys.stdin.readline()
        if not line:
            os._exit(1)  # the parent has exited
        values = json.loads(line)
        for point, value in zip(points, values, strict=True):
            if value is not None:
                point.setBBO(repr(value).encode("ascii"))
        return [value is not None for value in values]

    task = json.loads(sys.stdin.readline())
    k = len(task["start"])
    result = PyNomad.optimize(
        evaluate_block, task["start"], [0.0] * k, [1.0] * k, task["parameters"]
    )
    send({"ended": str(result.get("stop_reason", "")) if isinstance(result, dict) else ""})
    out.close()
    os._exit(0)


if __name__ == "__main__":
    main()
