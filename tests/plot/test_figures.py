from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexor
from flexor.errors import InputError
from flexor.plot import spatial
from flexor.plot.designs_figure import Design, draw_designs
from flexor.plot.path_figure import MAX_LEGEND_ENTRIES, draw_path
from flexor.plot.reading import read_scene
from flexor.plot.scene import LONGEST_ARROW, ContactArrow, Scene, arrow_scale
from flexor.plot.style import COLUMN, save, shades

from .synthetic import scene

FLEXION = np.linspace(0.0, 1.2, 6)
SCENES = [scene(flexion, 1.1 * flexion) for flexion in FLEXION]


def test_path_is_drawn_to_scale_at_every_load() -> None:
    figure = draw_path(SCENES, range(6), planar_model=True)
    axes = figure.axes[0]
    figure.draw_without_rendering()
    origin, unit = axes.transData.transform([(0.0, 0.0), (1.0, 1.0)])
    assert unit[0] - origin[0] == pytest.approx(unit[1] - origin[1], rel=1e-6)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["0 N", "1 N", "2 N", "3 N", "4 N", "5 N"]
    assert [text.get_text() for text in figure.legends[1].get_texts()] == ["chamber"]
    (last,) = [patch.get_xy() for patch in axes.patches if len(patch.get_xy()) == 83]
    # The others are outlines, which do not hide one another.
    others = [line.get_xydata() for line in axes.lines if len(line.get_xydata()) == 83]
    assert len(others) == 5
    # Each rod ends where its arc ends, in centimetres.
    for shown, drawn in zip(SCENES, [*others, last], strict=True):
        tip = 100.0 * shown.rods[0].frames[-1, [0, 2], 3]
        np.testing.assert_allclose(0.5 * (drawn[40] + drawn[41]), tip, atol=1e-9)
    assert figure.get_figwidth() == COLUMN


def test_everything_lies_inside_the_axes() -> None:
    axes = draw_path(SCENES, range(6), planar_model=True).axes[0]
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    for patch in axes.patches:
        x, z = patch.get_xy().T
        assert left < x.min() and x.max() < right and bottom < z.min() and z.max() < top


def test_arrows_share_one_scale_and_the_key_is_round() -> None:
    cm_per_newton, key = arrow_scale([scene(0.5, 3.7)])
    assert cm_per_newton * 3.7 == pytest.approx(LONGEST_ARROW)
    assert key == 2.0
    assert arrow_scale([scene(0.5)]) == (0.0, 0.0)


def test_keys_of_a_model_of_any_size_do_not_overlap() -> None:
    """Their texts are apart by more than their height, and clear of the bodies."""
    model = flexor.load("elbow", changes={"exosuit.elements": 10})
    figure = draw_path([read_scene(model.equilibrium())], [35.0], planar_model=True)
    figure.draw_without_rendering()
    axes = figure.axes[0]
    force, pressure, gravity = sorted(
        (each.get_window_extent() for each in axes.texts), key=lambda b: b.ymin
    )
    assert pressure.ymin > force.ymax and gravity.ymin > pressure.ymax
    bodies = [axes.transData.transform(each.get_xy())[:, 1].min() for each in axes.patches]
    assert gravity.ymax < min(bodies)


def test_arrow_ends_where_the_force_acts() -> None:
    import matplotlib.quiver

    acting = Scene(
        rods=scene(0.3).rods,
        contact_arrows=[ContactArrow(np.array([0.05, 0.0, 0.01]), np.array([0.0, 0.0, -2.0]))],
    )
    axes = draw_path([acting], [5.0], planar_model=True).axes[0]
    arrow = next(c for c in axes.collections if isinstance(c, matplotlib.quiver.Quiver))
    np.testing.assert_allclose(arrow.get_offsets(), [[5.0, 1.0]])
    assert arrow.pivot == "tip"
    np.testing.assert_allclose([arrow.U[0], arrow.V[0]], [0.0, -LONGEST_ARROW])


def test_the_legend_of_a_long_path_lists_some_loads() -> None:
    many = [scene(flexion) for flexion in np.linspace(0.0, 1.0, 51)]
    figure = draw_path(many, np.linspace(0.0, 5.0, 51), planar_model=True)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert len(labels) <= MAX_LEGEND_ENTRIES + 1
    assert {"0 N", "5 N"} <= set(labels)


def test_spatial_path_has_equal_scales() -> None:
    axes = draw_path(SCENES, range(6), planar_model=False).axes[0]
    spans = np.array(
        [np.diff(lim)[0] for lim in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())]
    )
    aspect = np.array(axes._box_aspect)
    np.testing.assert_allclose(aspect / aspect[0], spans / spans[0])


def test_designs_share_limits_and_titles_state_the_bending() -> None:
    designs = [
        Design("default", SCENES[0], SCENES[1], "0 N", "5 N", 0.43),
        Design("optimum", SCENES[0], SCENES[5], "0 N", "5 N", 1.43),
    ]
    figure = draw_designs(designs, planar_model=True)
    first, second = figure.axes
    assert first.get_xlim() == second.get_xlim() and first.get_ylim() == second.get_ylim()
    assert first.get_title() == "default: bends 25° (0.43 rad)"
    assert second.get_title() == "optimum: bends 82° (1.43 rad)"


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_files_are_reproducible(tmp_path, ending: str) -> None:
    files = []
    for name in "ab":
        figure = draw_path(SCENES, range(6), planar_model=True)
        files.append(save(figure, tmp_path / f"{name}.{ending}").read_bytes())
    assert files[0] == files[1]
    assert len(files[0]) > 10_000


def test_shades_run_from_light_to_dark() -> None:
    lightness = shades(7)[:, :3] @ [0.2126, 0.7152, 0.0722]
    assert np.all(np.diff(lightness) < 0.0)
    assert shades(1).shape == (1, 4)


@pytest.mark.parametrize(
    ("name", "words"), [("picture.jpeg", "must end in .png"), ("no/where/a.png", "no folder")]
)
def test_a_file_that_cannot_be_written_is_rejected(tmp_path, name: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        save(draw_path(SCENES, range(6), planar_model=True), tmp_path / name)


def test_drawing_does_not_change_matplotlib_settings() -> None:
    import matplotlib

    before = dict(matplotlib.rcParams)
    draw_path(SCENES, range(6), planar_model=True)
    assert dict(matplotlib.rcParams) == before


def test_designs_in_three_dimensions_have_their_sections() -> None:
    """Every triangle of the meshes that faces the eye is drawn, to the same scale as the rest."""
    import flexor
    from flexor import plot
    from flexor.scene import scene as solid_scene

    path = flexor.load("tendon-arm").equilibrium([0.0, 2.0])
    figure = plot.designs(path, path)
    objects = solid_scene(path).objects
    drawn = [each for each in objects if each.kind not in ("chamber", "line", "obstacle")]
    corners = np.concatenate(
        [each.vertices(-1)[each.faces] for each in drawn if each.part != "bone"]
    )
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    figure.draw_without_rendering()
    for axes in figure.axes:
        (size,) = [len(each.get_paths()) for each in axes.collections if each.get_rasterized()]
        up, round_ = np.radians([axes.elev, axes.azim])
        eye = [np.cos(up) * np.cos(round_), np.cos(up) * np.sin(round_), np.sin(up)]
        assert (normal @ eye > 0.0).sum() < size < 0.7 * len(corners)
        low, high = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()]).T
        vertices = np.concatenate([each.vertices() for each in drawn])
        assert (100.0 * vertices > low).all() and (100.0 * vertices < high).all()


def test_only_load_steps_that_have_converged_are_drawn() -> None:
    model = flexor.load("truss")
    path = model.equilibrium([0.0, 1.0, 2.0], max_iterations=1)
    assert path.converged.tolist() == [True, False, False]
    assert len(flexor.plot.path(path).legends[0].get_texts()) == 1
    with pytest.raises(InputError, match="no load step has converged"):
        flexor.plot.path(path[1:])


def test_the_legend_of_designs_with_many_loads_fits() -> None:
    loads = [f"first.chamber {i} kPa, second.chamber {i} kPa, third.chamber 0 kPa" for i in (1, 2)]
    designs = [Design("optimum", scene(0.1), scene(0.5), loads[0], each, 0.5) for each in loads]
    figure = draw_designs(designs, planar_model=True)
    figure.draw_without_rendering()
    box = figure.legends[0].get_window_extent()
    assert box.x0 >= 0.0 and box.x1 <= figure.bbox.width
    assert len(figure.legends) == 1


def test_a_model_whose_gravity_is_along_z_is_drawn_upside_down() -> None:
    """So that what falls, falls downwards; an arrow says where gravity acts."""
    heavy = replace(scene(0.5), gravity=np.array([0.0, 0.0, 9.81]))
    for each, up in ((heavy, False), (replace(heavy, gravity=-heavy.gravity), True)):
        figure = draw_path([each], [0.0], planar_model=True)
        axes = figure.axes[0]
        bottom, top = axes.get_ylim()
        assert (bottom < top) == up
        words = {text.get_text(): text for text in axes.texts}
        assert words.keys() == {"gravity"}
        # Below the model.
        low, high = (100.0 * end[2] for end in each.extent())
        assert words["gravity"].xy[1] < low if up else words["gravity"].xy[1] > high
    assert not draw_path([scene(0.5)], [0.0], planar_model=True).axes[0].texts


def test_the_legend_says_which_input_its_loads_are_of() -> None:
    path = flexor.load("finger-two-chambers").equilibrium()
    legends = flexor.plot.path(path).legends
    assert legends[0].get_title().get_text() == "middle-joint (knuckle 0 kPa to 20 kPa)"
    path = flexor.load("pneumatic-finger").equilibrium(["0 kPa"])
    assert flexor.plot.path(path).legends[0].get_title().get_text() == ""


def test_parts_of_one_material_have_one_colour(tmp_path) -> None:
    text = 'name = "two"\nplanar = true\n'
    text += "".join(f'[parts.{key}]\nfile = "pneumatic-finger"\n' for key in "ab")
    path = flexor.model.Model(flexor.model.parse(text)).equilibrium(np.zeros((1, 2)))
    figure = flexor.plot.designs(path, path)
    (legend,) = figure.legends
    words = [each.get_text() for each in legend.get_texts()]
    assert words[1].startswith("silicone, at ") and words.count("fabric") == 1
    assert figure.axes[0].get_title() == "start: bends 0° in all (2 limbs)"


def test_links_alone_have_the_colour_of_their_load_and_closed_ends() -> None:
    links = [replace(scene(bend), rods=[], lines=[]) for bend in (0.0, 0.5)]
    axes = draw_path(links, [0.0, 1.0], planar_model=False).axes[0]
    surfaces = axes.collections
    assert len(surfaces) == 6
    first, last = surfaces[0].get_facecolor(), surfaces[-1].get_facecolor()
    assert np.abs(first[0, :3] - last[0, :3]).max() > 0.1
    x, y, z = spatial._round_cone(links[0].links[0])
    for end in (0, -1):  # each ends in one point
        assert np.ptp([x[end], y[end], z[end]], axis=1).max() < 1e-12
    link = links[0].links[0]
    assert x.min() == pytest.approx(link.base[0] - link.radius_base)
    assert x.max() == pytest.approx(link.tip[0] + link.radius_tip)
