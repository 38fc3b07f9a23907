"""The study in short: where we agree with the paper, where not, and why."""

from __future__ import annotations

from collections.abc import Mapping

from flexor.paper import published
from flexor.paper.context import Context
from flexor.paper.default import default_design
from flexor.paper.optimum import Optimum
from flexor.paper.settings import PRINTED, SETS
from flexor.paper.table3 import published_design


def brief(
    context: Context, other: Context, best: Mapping[str, Optimum], also: Mapping[str, Optimum]
) -> tuple[str, ...]:
    """Say where we agree with the paper, where we differ, and why.

    Parameters
    ----------
    context, other : Context
        The study with its constants and with those of the other reading.
    best, also : dict of Optimum
        By parameter set, with the constants of each.

    Returns
    -------
    tuple of str
        Paragraphs.
    """
    names = tuple(each.settings.constants for each in (context, other))
    gains = [
        found["L+R01"].bending / float(default_design(each)["bending"])
        for each, found in ((context, best), (other, also))
    ]
    theirs = float(published_design(context, "L+RLP")["bending"])
    return (
        "What agrees: the counts of the model (degrees of freedom, contact spheres), the three "
        "printed angles once three constants that the paper leaves in doubt are fitted to them, "
        f"and that design pays: the optimum of L+R01 bends the finger {gains[0]:.1f} times as far "
        f'as the default with the constants "{names[0]}" and {gains[1]:.1f} times with '
        f'"{names[1]}".',
        "What differs first of all are the optima. In our model a longer exosuit bends the finger "
        f"further, up to the bound on its length or close to it: {_on_bound(context, best)}, "
        f"{_on_bound(other, also)}. The paper's lengths are "
        f"{100.0 * published.TABLE_III['L'].design[0]:.2f} to "
        f"{100.0 * published.TABLE_III['L+R01'].design[0]:.1f} cm; the bound is ours, the paper "
        f"names none. The best tip radius of R01 is {_tip(best)} or {_tip(also)} cm, the paper's "
        f"{100.0 * published.TABLE_III['R01'].design[1]:.2f} cm.",
        "Why we differ, as far as we can tell. The printed modulus with a chamber on the surface "
        f'(the constants "{PRINTED}") cannot have given the printed angles, so the model behind '
        "the paper's numbers had something that its text does not say. Not said are: contact "
        "stiffness, height and place of the exosuit's base, the law at the joint limits, where the "
        "spheres sit, which links the two-link finger merges, the bounds of the searches and what "
        "F_t is. We chose them as the model file says, and fitted three; what else was tried does "
        "not bring the published optima back (see the page on calibration). Besides, root finding "
        "may stop at an unstable equilibrium or cross to another branch unnoticed; Flexor follows "
        "stable equilibria and records every snap, so even the right constants might give another "
        "landscape.",
        "What no constants can mend: a set that holds another cannot be worse. The published "
        f"optimum of L+RLP bends {theirs:.2f} rad in our model, that of L+R01 "
        f"{published_design(context, 'L+R01')['bending']:.2f} rad; L+RLP holds the latter, so its "
        "true optimum is at least as good.",
    )


def _tip(best: Mapping[str, Optimum]) -> str:
    return f"{100.0 * best['R01'].design[1]:.2f}"


def _on_bound(context: Context, best: Mapping[str, Optimum]) -> str:
    """Say how many optimal lengths are on the upper bound."""
    long = [name for name in SETS if name.startswith("L")]
    upper = context.problem("L").parameters.upper[0]
    longest = sum(best[name].design[0] > upper - 1e-4 for name in long)
    shortest = min(best[name].design[0] for name in long)
    return (
        f'with "{context.settings.constants}" {longest} of {len(long)} optimal lengths are at the '
        f"bound of {100.0 * upper:.0f} cm and the shortest is {100.0 * shortest:.1f} cm"
    )
