"""Meshes and fields, compared with the sections, frames and results that they do not read."""

from __future__ import annotations

import numpy as np
import pytest

import flexor
from flexor.model import Model, parse
from flexor.model.schema.section_geometry import geometries
from flexor.plot.reading import read_scene
from flexor.scene import scene
from flexor.scene.connections import RADIUS, SIDES
from flexor.scene.frames import frames_of, refined, twists
from flexor.scene.links import profile
from flexor.scene.rods import Swept
from flexor.scene.straps import ROWS
from flexor.sections.outline import outline
from flexor.sections.shapes import moments

MATERIALS = """
[materials]
soft = { library = "ecoflex-00-30", winding = "hoop" }
fabric = { kind = "linear", young_modulus = "30 MPa" }
"""
SECTIONS = {
    "circular": '{ kind = "circular" }',
    "elliptic": '{ kind = "elliptic", ratio = 1.7 }',
    "rectangular": '{ kind = "rectangular", ratio = 0.6 }',
    "tube": '{ kind = "tube", wall = "2 mm" }',
    "half-round": '{ kind = "half-round", wall = "2 mm", floor = "2 mm", '
    'layer = { thickness = "0.5 mm", material = "fabric" } }',
    "box": '{ kind = "box", width = "15 mm", wall = "2 mm" }',
    "composite": '{ kind = "composite", torsion_stiffness = "1 N*mm^2", parts = ['
    ' { shape = "rectangle", y = "0 mm", z = "-3 mm", width = "12 mm", height = "2 mm" },'
    ' { shape = "half-ring", y = "0 mm", z = "-2 mm", radius = "6 mm", wall = "2 mm" } ] }',
}


def rod_model(section: str) -> flexor.Model:
    text = f"""
name = "rod"
{MATERIALS}
[bodies.rod]
kind = "rod"
length = "10 cm"
radius = {{ base = "8 mm", tip = "6 mm" }}
material = "soft"
section = {section}
strain = {{ bend_y = "nodal_linear", extend_x = "nodal_linear" }}
elements = 10
gauss_points = 2
"""
    return flexor.load(parse(text))


@pytest.fixture(scope="module")
def path() -> flexor.Path:
    return flexor.load("pneumatic-finger").equilibrium()


@pytest.fixture(scope="module")
def found(path):
    return scene(path)


@pytest.mark.parametrize("name", SECTIONS)
def test_meshes_of_sections_have_the_volume_of_the_section(name) -> None:
    model = rod_model(SECTIONS[name])
    meshes = scene(model.equilibrium([0.0])).objects
    s = np.linspace(8e-3, 6e-3, 4001)
    (_, geometry), *_ = geometries(model.file.rod("rod"), model.file.materials)[0]
    parts = [part for part in geometry.parts if not part.stiffening]
    assert len(meshes) == len(parts)
    for mesh, part in zip(meshes, parts, strict=True):
        area = np.polynomial.polynomial.polyval(s, moments((part.shape,))[:3])
        # A polygon of 48 sides has 0.3 % less than its circle.
        assert mesh.volume() == pytest.approx(0.1 * area.mean(), rel=4e-3)
        edges = np.sort(mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        # Closed: by position, since corners are two vertices.
        points = np.unique(np.round(mesh.vertices(), 9), axis=0, return_inverse=True)[1].ravel()
        merged = np.sort(points[edges], axis=1)
        merged = merged[merged[:, 0] != merged[:, 1]]
        _, counts = np.unique(merged, axis=0, return_counts=True)
        assert (counts % 2 == 0).all()


@pytest.mark.parametrize("name", SECTIONS)
def test_outlines_enclose_the_area_of_their_shape(name) -> None:
    model = rod_model(SECTIONS[name])
    (_, geometry), *_ = geometries(model.file.rod("rod"), model.file.materials)[0]
    for part in geometry.parts:
        line = outline(part.shape, np.array([8e-3]))
        (y, z), (i, j) = line.points[0].T, line.edges.T
        by_edges = 0.5 * float(np.sum(y[i] * z[j] - y[j] * z[i]))
        a, b, c = line.points[0][line.triangles].transpose(1, 0, 2)
        first, second = (b - a).T, (c - a).T
        each = 0.5 * (first[0] * second[1] - first[1] * second[0])
        assert (each >= -1e-15).all()
        assert by_edges == pytest.approx(each.sum(), rel=1e-12)
        area = np.polynomial.polynomial.polyval(8e-3, moments((part.shape,))[:3])
        assert by_edges == pytest.approx(area, rel=4e-3)


def test_strains_between_frames_are_those_of_the_fibres(path) -> None:
    file = path.model.file
    rod, name = file.rod("exosuit"), "exosuit"
    swept = Swept.of(path, name, frames_of(path)[name], file)
    built, of_gauss = geometries(rod, file.materials)
    index = {material: i for i, material in enumerate(file.materials)}
    least = np.full((len(path), len(index)), np.inf)
    most = -least
    for place, point in zip(of_gauss, rod.gauss_rule[0], strict=True):
        s = swept.surface[point]
        axial, bend_y, _ = swept.strain[:, point].T
        for fibre in built[place][1].fibres(index, folded=True):
            z = fibre["z"][0] + fibre["z"][1] * s
            stretch = fibre["stretch"] * (1.0 + axial + z * bend_y)
            material = fibre["material"]
            least[:, material] = np.minimum(least[:, material], stretch)
            most[:, material] = np.maximum(most[:, material], stretch)
    # Strain is linear between the frames and a twist there is its mean.
    np.testing.assert_allclose(least, path.stretch[..., 0], atol=2e-3)
    np.testing.assert_allclose(most, path.stretch[..., 1], atol=2e-3)


def test_colours_of_strain_go_beyond_the_fibres_only_to_the_surface(path, found) -> None:
    fields = [each.fields["strain"][-1] for each in found.objects if "strain" in each.fields]
    strain = max(float(field.max()) for field in fields)
    # Fibres stand for parts of the 2 mm wall; its outside is strained most.
    assert path.max_strain[-1] < strain < 1.25 * path.max_strain[-1]


def test_pressure_on_the_rod_has_the_largest_of_the_path(path, found) -> None:
    rods = [each for each in found.objects if each.kind == "rod" and each.part == "fabric"]
    largest = np.nanmax(rods[0].fields["contact-pressure"][1:], axis=1)
    np.testing.assert_allclose(largest, path.max_contact_pressure[1:], rtol=1e-6)
    assert np.isnan(rods[0].fields["contact-pressure"][0]).all()


def test_pressure_on_the_skin_adds_up_to_the_force_of_contact() -> None:
    fine = flexor.load("pneumatic-finger", changes={"exosuit.elements": 80}).equilibrium()
    contacts, places = fine.contact_forces(), fine.model.sphere_places
    touched = np.array([places[int(second)][0] for second in contacts.second])
    for each in scene(fine).objects:
        # Of ph_2, only the sphere that it shares with ph_1 is touched: see the next test.
        if each.part != "skin" or each.name == "ph_2":
            continue
        force = np.linalg.norm(contacts.force[touched == each.name].sum(axis=0))
        pressure = np.nan_to_num(each.fields["contact-pressure"][-1])
        a, b, c = each.vertices()[each.faces].transpose(1, 0, 2)
        vector = 0.5 * np.cross(b - a, c - a)
        total = np.linalg.norm((pressure[each.faces].mean(axis=1)[:, None] * vector).sum(axis=0))
        # The triangles are those of the drawing, some of which are as large as the contact is wide.
        assert total == pytest.approx(force, rel=0.03)


def test_pressure_at_a_joint_is_on_the_skins_of_both_links(found) -> None:
    first, second = (
        next(each for each in found.objects if each.name == name and each.part == "skin")
        for name in ("ph_1", "ph_2")
    )
    one, other = (each.fields["contact-pressure"][-1] for each in (first, second))
    joint = second.frames[-1, 0, :3, 3]
    radius = np.linalg.norm(second.vertices()[second.local[:, 0].argmin()] - joint)
    far = np.linalg.norm(second.vertices() - joint, axis=1)
    there = np.isfinite(other) & (far < 0.02)  # and not at the joint to ph_3
    assert there.sum() > 5
    np.testing.assert_allclose(far[there], radius, atol=1e-6)
    assert np.nanmax(other[there]) == pytest.approx(np.nanmax(one), rel=0.2)
    # Without it the triangles of both would be seen in turn.
    nearest = np.linalg.norm(second.vertices()[there][:, None] - first.vertices(), axis=2)
    same = one[nearest.argmin(axis=1)]
    near = nearest.min(axis=1) < 5e-4
    assert near.any()
    np.testing.assert_allclose(other[there][near], np.nan_to_num(same[near]), atol=4e3)


def test_round_cones_are_hulls_of_spheres() -> None:
    for length, first, second in [
        (0.045, 0.0216, 0.0139),
        (0.02, 0.004, 0.011),
        (0.005, 0.01, 0.001),
    ]:
        x, r = profile(length, first, second)
        t = np.linspace(0.0, 1.0, 20001)[:, None]
        outside = np.hypot(x - t * length, r) - (first + t * (second - first))
        np.testing.assert_allclose(outside.min(axis=0), 0.0, atol=1e-9)


def test_straps_enclose_what_they_hold(path, found) -> None:
    swept = Swept.of(path, "exosuit", frames_of(path)["exosuit"], path.model.file)
    for name, strap in path.model.file.straps.items():
        (ribbon,) = [each for each in found.objects if each.name == name]
        for step in (0, len(path) - 1):
            loop = ribbon.vertices(step).reshape(ROWS, -1, 3)[ROWS // 2]
            station = int(np.argmin(np.abs(swept.x - strap.at)))
            frame = swept.frames[step, station]
            around = frame[:3, 3] + swept.around(station) @ frame[:3, 1:3].T
            middle = loop.mean(axis=0)
            up = around.mean(axis=0) - middle
            for angle in np.linspace(0.0, np.pi, 7):
                direction = np.cos(angle) * frame[:3, 1] + np.sin(angle) * up / np.linalg.norm(up)
                reach = ((around - middle) @ direction).max()
                assert ((loop - middle) @ direction).max() > reach - 3e-4


def test_straps_do_not_cut_into_what_they_hold(path, found) -> None:
    """No point of their triangles is within the round cone of the link, a hull of spheres."""
    frames, share = frames_of(path), np.linspace(0.0, 1.0, 201)[:, None]
    for name, strap in path.model.file.straps.items():
        (ribbon,) = [each for each in found.objects if each.name == name]
        body = strap.to.body
        base, tip = (
            path.model.slot(f"{body}.radius_{end}", path.parameters) for end in ("base", "tip")
        )
        for step in (0, len(path) - 1):
            corners = ribbon.vertices(step)[ribbon.faces]
            points = np.concatenate([*corners.swapaxes(0, 1), corners.mean(axis=1)])
            first, last = frames[body][step, [0, -1], :3, 3]
            centres = first + share * (last - first)
            radii = (base + share * (tip - base))[:, 0]
            far = np.linalg.norm(points[:, None] - centres, axis=2) - radii
            assert far.min() > 0.0


def test_frames_between_frames_keep_a_constant_strain() -> None:
    stations = np.linspace(0.0, 0.1, 6)
    angle = 25.0 * stations  # an arc of curvature 25 / m in the x-z plane, about -y
    frames = np.tile(np.eye(4), (1, 6, 1, 1))
    frames[0, :, 0, 0] = frames[0, :, 2, 2] = np.cos(angle)
    frames[0, :, 0, 2], frames[0, :, 2, 0] = -np.sin(angle), np.sin(angle)
    frames[0, :, 0, 3], frames[0, :, 2, 3] = np.sin(angle) / 25.0, (1.0 - np.cos(angle)) / 25.0
    expected = np.tile([0.0, -25.0, 0.0, 1.0, 0.0, 0.0], (6, 1))
    np.testing.assert_allclose(twists(frames, stations)[0], expected, atol=1e-10)
    fine = refined(frames, 8)
    x, z = fine[0, :, 0, 3], fine[0, :, 2, 3]
    np.testing.assert_allclose(np.hypot(x, z - 0.04), 0.04, atol=1e-12)


def test_a_step_without_equilibrium_looks_as_the_one_before() -> None:
    path = flexor.load("pneumatic-finger").equilibrium()
    path.q[3] = np.nan
    frames = frames_of(path)["exosuit"]
    np.testing.assert_array_equal(frames[3], frames[2])
    assert len(scene(path).objects[0].frames) == len(path)


def test_sections_of_a_changed_file_are_drawn(path) -> None:
    thin = flexor.load("pneumatic-finger", changes={"exosuit.section.wall": "1.5 mm"})
    arcs = [scene(path, file).objects for file in (path.model.file, thin.file)]
    volume = [
        next(each.volume(0) for each in objects if each.kind == "chamber") for objects in arcs
    ]
    assert volume[1] > 1.05 * volume[0]


def test_scenes_of_other_models_have_their_parts() -> None:
    kinds = {}
    for name in ("finger", "tendon-arm", "exosuit-alone"):
        model = flexor.load(name)
        made = scene(model.equilibrium())
        kinds[name] = sorted({each.kind for each in made.objects})
        for each in made.objects:
            assert np.isfinite(each.vertices()).all()
            assert each.faces.max() < each.size
        assert "contact-pressure" not in made.scales  # spheres have none
    assert kinds["finger"] == ["line", "link", "rod"]
    assert "line" in kinds["tendon-arm"]


def test_obstacles_are_planes_through_their_point() -> None:
    text = flexor.load("finger").file.to_toml() + (
        '\n[obstacles.table]\nkind = "half-space"\nspheres = ["exosuit"]\n'
        'point = { z = "-3 cm" }\nnormal = [0.0, 0.0, 1.0]\nstiffness = "1 N/mm"\n'
    )
    model = flexor.load(parse(text))
    (plane,) = [o for o in scene(model.equilibrium([0.0])).objects if o.kind == "obstacle"]
    np.testing.assert_allclose(plane.vertices()[:, 2], -0.03, atol=1e-15)


@pytest.mark.parametrize(
    ("solid", "size", "volume"),
    [
        ('kind = "sphere"\nradius = "1 cm"', (0.02, 0.02, 0.02), 4.0 / 3.0 * np.pi * 1e-6),
        (
            'kind = "capsule"\nradius = "1 cm"\nlength = "3 cm"\naxis = "x"',
            (0.05, 0.02, 0.02),
            (4.0 / 3.0 + 3.0) * np.pi * 1e-6,
        ),
        (
            'kind = "box"\nsize = { x = "1 cm", y = "3 cm", z = "2 cm" }\nrounding = "0 mm"',
            (0.01, 0.03, 0.02),
            6e-6,
        ),
        ('kind = "sphere"\nradius = "1 m"\ninside = true', (2.0, 2.0, 2.0), -4.0 / 3.0 * np.pi),
    ],
)
def test_solid_obstacles_have_their_size_and_volume(
    solid: str, size: tuple[float, ...], volume: float
) -> None:
    """A mesh of eight steps a quarter is smaller by two percent; a sleeve is seen from inside."""
    text = flexor.load("finger").file.to_toml() + (
        '\n[obstacles.thing]\nspheres = ["exosuit"]\npoint = { z = "-9 cm" }\n'
        'stiffness = "1 N/mm"\n' + solid + "\n"
    )
    model = flexor.load(parse(text))
    (thing,) = [o for o in scene(model.equilibrium([0.0])).objects if o.kind == "obstacle"]
    np.testing.assert_allclose(np.ptp(thing.vertices(), axis=0), size, rtol=1e-9)
    assert thing.volume() == pytest.approx(volume, rel=0.02)
    edges = np.sort(thing.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()


def test_springs_are_coils_between_their_ends() -> None:
    """They follow the apex of the truss, and their coil stays as wide."""
    path = flexor.load("truss").equilibrium()
    found = scene(path)
    left, right = [each for each in found.objects if each.kind == "spring"]
    apex = 0.02 + path.q[:, 0]
    for each, end in ((left, -0.1), (right, 0.1)):
        ring = each.positions.reshape(len(path), -1, 5, 3).mean(axis=2)
        np.testing.assert_allclose(ring[:, 0, 0], 0.0, atol=1e-12)
        np.testing.assert_allclose(ring[:, 0, 2], apex, atol=1e-12)
        np.testing.assert_allclose(
            ring[:, -1], np.tile([end, 0.0, 0.0], (len(path), 1)), atol=1e-12
        )
        np.testing.assert_allclose(np.abs(ring[:, :, 1]).max(axis=1), 4e-3, rtol=1e-6)
    low, high = found.extent()
    assert low[0] < -0.1 and high[0] > 0.1


def test_ties_are_marked_where_they_are() -> None:
    """The motor stays at the crank's axis, and the pin goes with the tip of the coupler."""
    path = flexor.load("four-bar").equilibrium()
    motor, pin = [each for each in scene(path).objects if each.kind == "tie"]
    assert (motor.name, pin.name) == ("crank-motor", "pin")
    # 1.3 times as large as the links, 3 mm in radius: a barrel along y, and a ball.
    largest = 1.3 * 3e-3
    np.testing.assert_allclose(
        np.ptp(motor.vertices(), axis=0), largest * np.array([1.4, 2.4, 1.4]), rtol=1e-9
    )
    assert pin.volume() == pytest.approx(4.0 / 3.0 * np.pi * largest**3, rel=0.1)
    for step in range(len(path)):
        np.testing.assert_allclose(motor.vertices(step).mean(axis=0), 0.0, atol=1e-12)
        tip = path.frames(step)["coupler"][-1, :3, 3]
        np.testing.assert_allclose(pin.vertices(step).mean(axis=0), tip, atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "volume", "axis"),
    [("weld", 8.0, ""), ("slider", 5.0 * np.pi * 0.25, 'axis = "z"')],
)
def test_marks_of_ties_are_closed(kind: str, volume: float, axis: str) -> None:
    """Each is counter-clockwise seen from outside, and so has its volume."""
    four_bar = flexor.load("four-bar").file.to_toml()
    text = four_bar.replace('kind = "pin"', f'kind = "{kind}"\n{axis}')
    path = flexor.load(parse(text)).equilibrium([0.0])
    mark = [each for each in scene(path).objects if each.kind == "tie"][1]
    assert mark.volume() == pytest.approx(volume * (1.3 * 3e-3) ** 3, rel=0.03)


def test_points_with_friction_are_marked_where_they_are() -> None:
    path = flexor.load("capstan").equilibrium()
    marks = {each.part: each for each in scene(path).objects if each.kind == "friction"}
    assert set(marks) == {"holds", "slides"}
    for step in (0, 3, -1):
        points = path.friction_forces(step)
        for part, slides in (("holds", False), ("slides", True)):
            found, chosen = marks[part], points.slides == slides
            corners = found.vertices(step)[found.faces]
            shown = np.linalg.norm(np.cross(*np.diff(corners, axis=1).swapaxes(0, 1)), axis=1) > 0.0
            assert shown.sum() == chosen.sum() * len(found.faces) / found.frames.shape[1]
            for place in points.place[chosen]:
                near = np.linalg.norm(corners[shown].mean(axis=1) - place, axis=1).min()
                assert near < 2e-3
        if points.slides.any():
            tips = marks["slides"].vertices(step).reshape(marks["slides"].frames.shape[1], -1, 3)
            force = points.force[points.slides]
            along = (tips[: len(force), -2] - tips[: len(force), -1]) / 2.6
            cosine = np.einsum("mi,mi->m", along, force) / np.linalg.norm(force, axis=1)
            np.testing.assert_allclose(cosine, np.linalg.norm(along, axis=1), rtol=1e-12)


def test_models_without_friction_have_no_marks(found) -> None:
    assert all(each.kind != "friction" for each in found.objects)


BRACKET = """
name = "bracket"
[bodies.finger]
kind = "link"
length = "5 cm"
radius = "8 mm"
joint = { kind = "revolute", stiffness = "0.1 N*m/rad" }
[bodies.on]
kind = "link"
parent = "finger"
length = "1 cm"
radius = "8 mm"
[bodies.bracket]
kind = "link"
parent = "on"
length = "1 mm"
radius = "1 mm"
placement = { x = "4 mm", z = "3 cm" }
[wrenches.turn]
body = "finger"
at = "base"
moment = { y = "1 N*m" }
input = true
"""


def test_what_a_link_hangs_on_is_drawn() -> None:
    """Where it is placed away from the tip of its parent, and turns with that; no other has any."""
    path = Model(parse(BRACKET)).equilibrium([0.0, 0.1])
    found = [each for each in scene(path).objects if each.kind == "link" and each.part == "bone"]
    (bone,) = found
    assert bone.name == "bracket"
    radius, length = RADIUS * np.hypot(4e-3, 3e-2), np.hypot(4e-3, 3e-2)
    sides = 0.5 * SIDES * np.sin(2.0 * np.pi / SIDES)
    for step in range(len(path)):
        assert bone.volume(step) == pytest.approx(sides * radius**2 * length, rel=1e-9)
        ends = [path.frames(step)["on"][-1, :3, 3], path.frames(step)["bracket"][0, :3, 3]]
        centre = bone.vertices(step).mean(axis=0)
        np.testing.assert_allclose(centre, np.mean(ends, axis=0), atol=1e-15)
    (line,) = read_scene(path).lines
    np.testing.assert_allclose(line.points, ends)
    assert line.label == ""
