"""Comparison with other libraries on the same tasks, interleaved in one run.

Processor time of all threads per problem, with Flexor on one thread; the first call of a peer,
which includes compilation, is listed separately. Results are compared to the accuracy of the peer;
the exit code is 1 if one deviates by more. Peers that are not installed are skipped, with the
command that installs them (the extra `peers` includes all).
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
    """Run the benchmark and print its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=3, help="number of runs; medians are reported")
    parser.add_argument("--quick", action="store_true", help="smaller batches")
    arguments = parser.parse_args()
    section, good = measure(arguments.runs, quick=arguments.quick)
    section.report()
    return 0 if good else 1


def measure(runs: int, *, quick: bool) -> tuple[Section, bool]:
    """Run the benchmark; return its report and whether all results agree."""
    result = table(
        *("", "peer", "its time", "Flexor's", "ratio", "first call", "deviation", "expected"),
        text=2,
    )
    notes, missing, good = list[str](), list[str](), True
    for peer in PEERS:
        try:
            contests = peer(quick)
        except Missing as gone:
            missing.append(
                f"{gone} is not installed and was skipped: install it with "
                f"`{install_command(str(gone))}`."
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
            result.add_row(
                *(number, contest.peer, duration(theirs), duration(ours), f"{theirs / ours:,.0f}"),
                duration(first.median),
                f"{deviation:.0e}" + " (!)" * (not agrees),
                f"{contest.expected:.0e}",
            )
            notes.append(
                f"{number}. {contest.peer}: {contest.work}. Compared: {contest.compared}"
                f"{': ' * bool(remark)}{remark}. Differences: {contest.unlike}."
            )
    section = Section("Peers", "./dev bench peers" + " --quick" * quick)
    section.parts += [
        "Processor time of all threads for the same problem, interleaved in one run, with Flexor "
        "on one thread. The first call of a peer includes compilation. *Deviation* is the "
        "difference between its result and Flexor's, relative to the scale of the quantity, and "
        "*expected* is the error allowed by its tolerance and discretisation.",
        result,
        "\n".join(notes),
        *missing,
    ]
    return section, good


def duration(seconds: float) -> str:
    """Format a time with three digits."""
    factor, unit = next(x for x in UNITS if seconds * x[0] >= 1.0 or x is UNITS[-1])
    return f"{seconds * factor:.3g} {unit}"


if __name__ == "__main__":
    sys.exit(main())
