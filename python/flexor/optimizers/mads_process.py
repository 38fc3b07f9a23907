"""The process in which NOMAD runs: it asks for blocks of designs and is answered with values.

NOMAD keeps its random state between runs, takes over Ctrl-C and cannot be stopped from a callback,
so each run is a process of its own, spoken to in lines of JSON: one line in with the parameters,
then lines out with points and lines in with their values (null for a failure), a last line out with
why it ended.
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

    # NOMAD prints warnings; the conversation must stay clean. The parent decides about Ctrl-C.
    out = os.fdopen(os.dup(1), "w", encoding="ascii")
    os.dup2(2, 1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def say(message: dict[str, Any]) -> None:
        out.write(json.dumps(message) + "\n")
        out.flush()

    def answer(block: Any) -> list[bool]:
        ones = [block.get_x(i) for i in range(block.size())]
        say({"points": [[one.get_coord(j) for j in range(one.size())] for one in ones]})
        line = sys.stdin.readline()
        if not line:
            os._exit(1)  # the parent is gone
        values = json.loads(line)
        for one, value in zip(ones, values, strict=True):
            if value is not None:
                one.setBBO(repr(value).encode("ascii"))
        return [value is not None for value in values]

    task = json.loads(sys.stdin.readline())
    k = len(task["start"])
    ended = PyNomad.optimize(answer, task["start"], [0.0] * k, [1.0] * k, task["parameters"])
    say({"ended": str(ended.get("stop_reason", "")) if isinstance(ended, dict) else ""})
    out.close()
    os._exit(0)


if __name__ == "__main__":
    main()
