"""Files that are imported, and those that are refused, with what is said about them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from flexor.errors import InputError
from flexor.exchange import document_of, mjcf_of, read_limb
from flexor.exchange.xml import MAX_DEPTH
from flexor.model import Model, load, parse
from flexor.model.reading import check

BODY = '<mujoco><worldbody><body name="a">{}</body></worldbody>{}</mujoco>'
URDF = """
<robot name="claw">
  <link name="base"/>
  <link name="finger">
    <visual><geometry><mesh filename="f.stl"/></geometry></visual>
    <collision name="pad"><origin xyz="0.02 0 0" rpy="0 1.5707963267948966 0"/>
      <geometry><capsule radius="0.005" length="0.03"/></geometry></collision>
  </link>
  <link name="slider"/>
  <joint name="hinge" type="revolute">
    <parent link="base"/><child link="finger"/>
    <origin xyz="0.1 0 0.02" rpy="0.1 -0.2 0.3"/>
    <axis xyz="0 0 1"/><limit lower="-0.5" upper="1.2" effort="1" velocity="1"/>
    <dynamics damping="0.1"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="finger"/><child link="slider"/>
    <origin xyz="0.03 0 0"/><axis xyz="1 0 0"/><limit lower="-0.01" upper="0.02"/>
  </joint>
</robot>
"""


def written(folder: Path, text: str, name: str = "limb.xml") -> Path:
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("inside", "beside", "message"),
    [
        ("<hinge/>", "", "<hinge> is not an element of a body that is known here"),
        ("", "<flex/>", "<flex> is not an element of MJCF that is known here"),
        ('<joint type="screw"/>', "", 'has type="screw": expected one of "hinge", "slide"'),
        ('<joint axis="0 0 0"/>', "", "has an axis of length zero"),
        ('<joint pos="0 0"/>', "", 'has pos="0 0": expected 3 numbers'),
        ('<joint pos="0 0 x"/>', "", 'has pos="0 0 x": expected 3 numbers'),
        ('<joint pos="0 0 inf"/>', "", 'has pos="0 0 inf": expected 3 numbers'),
        ('<joint range="3 3"/>', "", "has an empty range"),
        ('<geom type="capsule" fromto="0 0 0 0 0 0" size="1"/>', "", "two equal ends"),
        ('<geom type="capsule"/>', "", "has no positive size"),
        (
            '<geom name="bone" type="mesh" mesh="bone"/>',
            "",
            '<geom name="bone"> is the mesh "bone", with which contact is not computed: replace it '
            "by capsules or spheres, or leave meshes out with --skip-meshes",
        ),
        ('<geom class="soft" size="1"/>', "", 'is of the class "soft", which no default defines'),
        ('<geom quat="1 0 0 0" euler="0 0 0" size="1"/>', "", "has both quat and euler"),
        ('<body name="a"/>', "", '<body name="a"> has the name of another body'),
        ("", '<compiler coordinate="global"/>', 'has coordinate="global"'),
        ("", '<compiler eulerseq="xyw"/>', 'has eulerseq="xyw"'),
        ("", '<tendon><spatial><site site="s"/></spatial></tendon>', 'passes the site "s"'),
        (
            '<geom name="g" type="box" size="1 1 1"/>',
            '<tendon><spatial><geom geom="g"/></spatial></tendon>',
            'wraps around the sphere or cylinder "g": there is none',
        ),
        ("", '<actuator><motor tendon="t"/></actuator>', 'pulls on the tendon "t", which there'),
        (
            "",
            '<tendon><spatial name="t"/></tendon><actuator><motor tendon="t" gear=""/></actuator>',
            "has a gear without numbers",
        ),
        ("", '<include file="limb.xml"/>', "once more: a file is included once"),
        ("", '<include file="/etc/passwd"/>', "a path within the file's folder is expected"),
        ("", '<include file="no.xml"/>', "no such file or directory"),
    ],
)
def test_mjcf_that_is_refused(tmp_path: Path, inside: str, beside: str, message: str) -> None:
    file = written(tmp_path, BODY.format(inside, beside))
    with pytest.raises(InputError) as error:
        read_limb(file)
    assert message in str(error.value)
    assert str(tmp_path) in str(error.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<mujoco>", "not valid XML at line 1: no element found"),
        ("", "not valid XML at line 1: no element found"),
        (
            "<OpenSimDocument/>",
            "is a model of OpenSim, which is not read: convert it to MJCF",
        ),
        ("<sdf/>", "begins with <sdf>, which is neither <mujoco> (MJCF) nor <robot> (URDF)"),
        ("<mujoco/>", "has no bodies"),
        (
            '<!DOCTYPE m [<!ENTITY a "b">]><mujoco>&a;</mujoco>',
            "line 1: document types and entities are not read",
        ),
        ("<m>" * (MAX_DEPTH + 2), "nested more than"),
        (URDF.replace("capsule radius", "mesh filename"), "leave meshes out with --skip-meshes"),
        (URDF.replace('"prismatic"', '"planar"'), 'has type="planar": expected one of "revolute"'),
        (URDF.replace('<child link="slider"/>', ""), "has as child none"),
        (URDF.replace('<child link="slider"/>', '<child link="x"/>'), 'the link "x", which there'),
        (URDF.replace('parent link="base"', 'parent link="slider"'), "is its own ancestor"),
        (URDF.replace('lower="-0.5"', 'lower="2"'), "has limits without room between them"),
    ],
)
def test_files_that_are_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=r"limb\.xml") as error:
        read_limb(written(tmp_path, text))
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("actuator", "left_out"),
    [
        ('<motor tendon="t" gear="-1"/>', set()),
        (
            '<motor tendon="t" gear="2" ctrlrange="0 10"/>',
            {
                "the sign of <motor> that lengthens its tendon, now a tension",
                "gears of <motor> on tendons",
                "ctrlrange of actuators",
            },
        ),
        ('<position tendon="t" kp="50"/>', {"laws of <position> on tendons, now tensions"}),
    ],
)
def test_what_a_tension_does_not_have_is_listed(
    tmp_path: Path, actuator: str, left_out: set[str]
) -> None:
    inside = '<site name="s"/><body name="b" pos="1 0 0"><joint/><site name="e"/></body>'
    path = '<site site="s"/><site site="e"/>'
    beside = f'<tendon><spatial name="t">{path}</spatial></tendon><actuator>{actuator}</actuator>'
    assert set(read_limb(written(tmp_path, BODY.format(inside, beside))).left_out) == left_out


def test_urdf(tmp_path: Path) -> None:
    limb = read_limb(written(tmp_path, URDF))
    assert dict(limb.left_out) == {"<dynamics> of joints": 1, "<visual> of links": 1}
    made = document_of(limb)
    model = Model(check(made.tables))
    assert [joint["body"] for joint in model.engine.joints] == ["finger", "slider"]
    turn, moved = 0.7, 0.012
    frames = model.engine.frames(model.parameters, np.array([turn, moved]))
    # Fixed axes: Rz(0.3) Ry(-0.2) Rx(0.1), then the hinge about its own z axis.
    c, s = np.cos, np.sin
    rx = np.array([[1, 0, 0], [0, c(0.1), -s(0.1)], [0, s(0.1), c(0.1)]])
    ry = np.array([[c(-0.2), 0, s(-0.2)], [0, 1, 0], [-s(-0.2), 0, c(-0.2)]])
    rz = np.array([[c(0.3), -s(0.3), 0], [s(0.3), c(0.3), 0], [0, 0, 1]])
    hinge = np.array([[c(turn), -s(turn), 0], [s(turn), c(turn), 0], [0, 0, 1]])
    expected = np.array([0.1, 0.0, 0.02]) + rz @ ry @ rx @ hinge @ [0.03 + moved, 0.0, 0.0]
    assert np.allclose(frames[model.body_frames["slider"][0], :3, 3], expected, atol=1e-15)
    start, stop = model.body_frames["pad"]
    assert np.linalg.norm(frames[stop - 1, :3, 3] - frames[start, :3, 3]) == pytest.approx(0.03)
    joint = model.file.bodies["finger"].joint
    assert (float(joint.lower), float(joint.upper)) == (-0.5, 1.2)


def test_includes_replace_themselves(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    written(tmp_path / "parts", '<mujocoinclude><joint name="j"/></mujocoinclude>', "joint.xml")
    file = written(tmp_path, BODY.format('<include file="parts/joint.xml"/>', ""))
    (joint,) = read_limb(file).bodies["a"].joints
    assert (joint.name, joint.kind, joint.axis.tolist()) == ("j", "hinge", [0.0, 0.0, 1.0])


def test_a_model_written_as_mjcf_is_the_same_when_read(tmp_path: Path) -> None:
    """Links, joints and tendons there and back: places and lengths at random states."""
    reference = Path(__file__).parents[1] / "reference" / "limb.xml"
    once = Model(check(document_of(read_limb(reference)).tables))
    text, left_out = mjcf_of(once.file)
    assert left_out["toes of springs"] == 1
    made = document_of(read_limb(written(tmp_path, text)))
    twice = Model(check(made.tables))
    random = np.random.default_rng(2)
    first, second = (
        [joint["coordinate"] for joint in model.engine.joints] for model in (once, twice)
    )
    tendons = [twice.tendons.index(made.tendons[name]) for name in once.tendons]
    for _ in range(10):
        q = random.uniform(-0.4, 0.4, once.dof)
        other = np.zeros(twice.dof)
        other[second] = q[first]
        lengths = once.engine.tendon_lengths(once.parameters, q)
        again = twice.engine.tendon_lengths(twice.parameters, other)[tendons]
        assert np.allclose(lengths, again, rtol=0.0, atol=1e-12)
        tension = [
            m.engine.tendon_tensions(m.parameters, x, np.ones(len(m.inputs)))
            for m, x in ((once, q), (twice, other))
        ]
        muscle = once.tendons.index("extensor")
        assert tension[1][tendons[muscle]] == pytest.approx(tension[0][muscle], rel=1e-9)


def test_a_rod_in_the_way_of_mjcf_is_named() -> None:
    with pytest.raises(InputError, match=r'parent is the rod "arm": MJCF is written of links only'):
        mjcf_of(parse(HANGING))
    text, left_out = mjcf_of(load("pneumatic-finger").file)
    assert text.count("<body ") == 3
    assert left_out["rods"] == 1


HANGING = """
name = "hanging"
[bodies.arm]
kind = "rod"
length = "10 cm"
radius = "5 mm"
young_modulus = "1 MPa"
poisson_ratio = 0.5
strain = { bend_y = "nodal_linear" }
gauss_points = 2
[bodies.hand]
kind = "link"
parent = "arm"
length = "5 cm"
radius = "5 mm"
"""
