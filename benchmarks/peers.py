"""Peers side by side: the same work by other libraries and by Flexor, in one run and by turns.

Processor time of all threads for each problem, Flexor on one thread; the first call of a peer, in
which it compiles, apart. Each answer is compared with Flexor's to the accuracy that the peer can
give; the exit code is 1 if one deviates by more. Peers that are missing are left out,
with the command that installs them (the extra `peers` has all of them).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

import _peer_elastica
import _peer_exudyn
import _peer_scipy
import _peer_soromox
from _contest import Contest
from _section import Missing, Section, table
from _timing import Times, by_turns

from flexor.installing import install_command

PEERS: tuple[Callable[[bool], list[Contest]], ...] = (
    _peer_soromox.contests,
    _peer_elastica.contests,
    _peer_exudyn.contests,
    _peer_scipy.contests,
)


UNITS = ((1.0, "s"), (1e3, "ms"), (1e6, "µs"))


def main() -> int:
    """Measure, and print the table."""
    reading = argparse.ArgumentParser(description=__doc__)
    reading.add_argument("--runs", type=int, default=3, help="of which medians are shown")
    reading.add_argument("--quick", action="store_true", help="smaller batches")
    asked = reading.parse_args()
    section, good = measure(asked.runs, quick=asked.quick)
    section.report()
    return 0 if good else 1


def measure(runs: int, *, quick: bool) -> tuple[Section, bool]:
    """Measure everything, and write it up; say whether all answers agree."""
    made = table(
        *("", "peer", "its time", "Flexor's", "ratio", "first call", "deviation", "expected"),
        text=2,
    )
    notes, missing, good = list[str](), list[str](), True
    for peer in PEERS:
        try:
            contests = peer(quick)
        except Missing as gone:
            missing.append(
                f"{gone} is not installed and was left out: `{install_command(str(gone))}` "
                "brings it."
            )
            continue
        for contest in contests:
            first = Times()
            first.run(contest.theirs)
            deviation, remark = contest.deviation()
            works = {"theirs": contest.theirs, "ours": contest.ours}
            times = by_turns(works, runs, contest.peer)
            theirs, ours = (
                times[name].median / units for name, units in zip(works, contest.units, strict=True)
            )
            agrees = deviation <= contest.expected
            good &= agrees
            number = str(len(notes) + 1)
            made.add_row(
                *(number, contest.peer, duration(theirs), duration(ours), f"{theirs / ours:,.0f}"),
                duration(first.median),
                f"{deviation:.0e}" + " (!)" * (not agrees),
                f"{contest.expected:.0e}",
            )
            notes.append(
                f"{number}. {contest.peer}: {contest.work}. Compared: {contest.compared}"
                f"{': ' * bool(remark)}{remark}. Not the same work: {contest.unlike}."
            )
    section = Section("Peers", "./dev bench peers" + " --quick" * quick)
    section.parts += [
        "The same work by other libraries and by Flexor, by turns in one run: processor time of "
        "all threads for one problem, with Flexor on one thread. In its first call a peer also "
        "compiles what it has to. *Deviation* is between its answer and Flexor's, relative to the "
        "scale of the quantity, and *expected* what its tolerance and discretisation allow.",
        made,
        "\n".join(notes),
        *missing,
    ]
    return section, good


def duration(seconds: float) -> str:
    """Write a time with three digits."""
    factor, unit = next(x for x in UNITS if seconds * x[0] >= 1.0 or x is UNITS[-1])
    return f"{seconds * factor:.3g} {unit}"


if __name__ == "__main__":
    sys.exit(main())
