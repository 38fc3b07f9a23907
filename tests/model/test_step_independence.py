"""Random systems in space reach the same states by the same events with few and many load steps."""

from __future__ import annotations

import numpy as np

from flexor.model import Model, parse

ROD = """
[bodies.b{i}]
kind = "rod"
{parent}
length = "{length} m"
radius = "{radius} m"
section = {{ kind = "rectangular", ratio = {ratio} }}
young_modulus = "{modulus} Pa"
poisson_ratio = 0.4
strain = {{ twist_x = "nodal_linear", bend_y = "nodal_linear", bend_z = "nodal_linear" }}
elements = 3
gauss_points = 2
placement = {{ rotation = {rotation} }}
"""
LINK = """
[bodies.b{i}]
kind = "link"
{parent}
length = "{length} m"
radius = "5 mm"
joint = {{ kind = "spherical", stiffness = "{stiffness} N*m/rad" }}
placement = {{ rotation = {rotation} }}
"""
SPRING = """
[springs.s{i}]
stiffness = "{stiffness} N/m"
rest_length = "{rest} m"
first = {{ body = "b{body}", at = "tip" }}
second = {{ world = {place} }}
"""
LOAD = """
[wrenches.p]
body = "b{body}"
at = "tip"
force = {force}
input = true
"""


def random_system(seed: int) -> Model:
    """Return a tree of rods and links in space, held by springs and pulled at a tip."""
    random = np.random.default_rng(seed)

    def vector(unit: str, size: float = 1.0) -> str:
        parts = zip("xyz", size * random.normal(size=3), strict=True)
        return "{ " + ", ".join(f'{axis} = "{x} {unit}"' for axis, x in parts) + " }"

    count = int(random.integers(1, 4))
    text = 'name = "random"\n'
    for i in range(count):
        numbers = {
            "i": i,
            "parent": f'parent = "b{random.integers(0, i)}"' if i else "",
            "length": random.uniform(0.1, 0.3),
            "rotation": vector("rad"),
            "radius": random.uniform(0.003, 0.01),
            "ratio": random.uniform(0.5, 3.0),
            "modulus": 10 ** random.uniform(5.0, 6.0),
            "stiffness": 10 ** random.uniform(-3.0, -1.5),
        }
        text += (ROD if i == 0 or random.random() < 0.7 else LINK).format(**numbers)
    for i in range(int(random.integers(0, 3))):
        text += SPRING.format(
            i=i,
            stiffness=10 ** random.uniform(-0.5, 1.5),
            rest=random.uniform(0.0, 0.3),
            body=random.integers(0, count),
            place=vector("m", 0.2),
        )
    text += LOAD.format(body=count - 1, force=vector("N", 10 ** random.uniform(-0.3, 0.7)))
    return Model(parse(text))


def test_the_load_steps_do_not_matter() -> None:
    alike, events = 0, 0
    seeds = range(60)
    for seed in seeds:
        model = random_system(seed)
        few, many = (model.equilibrium(np.linspace(0.0, 1.0, steps)) for steps in (3, 300))
        assert few.converged.all() and many.converged.all()
        same_events = [e.kind for e in few.events] == [e.kind for e in many.events]
        alike += same_events and bool(np.abs(few.q[-1] - many.q[-1]).max() < 1e-6)
        events += len(many.events)
    assert alike >= 0.95 * len(seeds)
    assert events >= 3
