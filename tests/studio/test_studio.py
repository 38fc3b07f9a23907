"""The studio's answers, and who gets them."""

from __future__ import annotations

import http.client
import json
import socket
import threading
import time

import numpy as np
import pytest

import flexor
from flexor.cli.app import main
from flexor.model import parse
from flexor.studio import serve, workbench
from flexor.studio.search import search
from flexor.study import Problem

BOUNDS = {"exosuit.section.wall": ("1.5 mm", "3 mm"), "exosuit.length": ("9 cm", "11 cm")}


@pytest.fixture(scope="module")
def bench():
    model = flexor.load("pneumatic-finger")
    problem = Problem.of(
        model, BOUNDS, "maximise range-of-motion", subject_to=["overlap <= 1.2 mm"]
    )
    return workbench(model, problem, source="finger.toml")


@pytest.fixture(scope="module")
def running(bench):
    studio = serve(bench).start()
    yield studio
    studio.stop()


def ask(port: int, name: str, body: object, **headers: str) -> tuple[int, bytes]:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    sent = {"Content-Type": "application/json", **headers}
    connection.request("POST", f"/api/{name}", json.dumps(body), sent)
    answer = connection.getresponse()
    found = answer.status, answer.read()
    connection.close()
    return found


def test_sliders_have_units_and_bounds(bench) -> None:
    described = bench.describe()
    wall, length = described["variables"]
    assert (wall["name"], wall["unit"], wall["low"], wall["high"], wall["start"]) == (
        "exosuit.section.wall", "mm", 1.5, 3.0, 2.0)  # fmt: skip
    assert (length["unit"], length["start"]) == ("cm", 10.0)
    (chamber,) = described["loads"]
    assert (chamber["unit"], chamber["low"], chamber["high"]) == ("kPa", 0.0, 120.0)


def test_a_design_is_that_of_its_changed_file(bench) -> None:
    changes = {"exosuit.section.wall": "2.5 mm", "exosuit.length": "9.5 cm"}
    model = flexor.load("pneumatic-finger", changes=changes)
    expected = model.equilibrium("0:40:8 kPa")
    answer = bench.solve([2.5, 9.5], [40.0])["design"]
    angles = next(plot for plot in answer["plots"] if plot["title"] == "Angles")
    by_name = {each["name"]: each["values"] for each in angles["series"]}
    found = np.radians([by_name[f"angle.ph_{i}"] for i in (1, 2, 3)]).T
    np.testing.assert_allclose(found, expected.joint_angles, atol=1e-8)
    assert answer["labels"][-1] == "40 kPa"
    assert [row["text"] for row in answer["verdict"]["constraints"]][-1] == "overlap <= 1.2 mm"
    again = flexor.load(parse(bench.model_file([2.5, 9.5]))).equilibrium("0:40:8 kPa")
    np.testing.assert_allclose(again.joint_angles, expected.joint_angles, atol=1e-8)
    np.testing.assert_allclose(
        bench.results([2.5, 9.5], [40.0])["joint_angles"], expected.joint_angles, atol=1e-8
    )


def test_arrays_that_the_page_has_are_not_sent_again(bench) -> None:
    first = bench.solve([2.0, 10.0], [60.0])
    again = bench.solve([2.0, 10.0], [60.0], list(first["blobs"]))
    other = bench.solve([2.2, 10.0], [60.0], list(first["blobs"]))
    assert again["blobs"] == {}
    assert again["design"]["scene"] == first["design"]["scene"]
    assert 0 < len(other["blobs"]) < len(first["blobs"])


def test_landscape_is_the_objective_of_each_design(bench) -> None:
    rows = {row["row"]: row for row in bench.landscape([2.0, 10.0], [60.0], [0, 1], 5)}
    assert sorted(rows) == [0, 1, 2, 3, 4]
    walls, lengths = np.linspace(1.5e-3, 3e-3, 5), np.linspace(0.09, 0.11, 5)
    paths = bench.problem.evaluate(np.array([[walls[3], lengths[1]], [walls[0], lengths[4]]]))
    assert rows[1]["shown"][3] == pytest.approx(paths.shown[0])
    assert rows[4]["shown"][0] == pytest.approx(paths.shown[1])
    assert rows[4]["broken"][0] == bool(paths.violation[1] > 0.0)
    turned = {row["row"]: row for row in bench.landscape([2.0, 10.0], [60.0], [1, 0], 5)}
    np.testing.assert_array_equal(
        np.array([turned[k]["shown"] for k in range(5)]).T,
        np.array([rows[k]["shown"] for k in range(5)]),
    )


def test_search_improves_and_ends_when_nobody_listens(bench) -> None:
    rows = [row for row in search(bench, [2.0, 10.0], [60.0], "pattern-search", 30, 0) if row]
    assert rows[-1]["ended"]
    assert rows[-1]["evaluations"] <= 30
    assert rows[0]["evaluations"] == 0
    assert rows[0]["shown"] < rows[-1]["shown"]
    study = flexor.optimize(
        bench.model, BOUNDS, "maximise range-of-motion", "pattern-search",
        subject_to=["overlap <= 1.2 mm"], budget=30)  # fmt: skip
    np.testing.assert_allclose(
        np.array(rows[-1]["values"]) * bench.problem.parameters.scale, study.best.vector
    )
    before = threading.active_count()
    endless = search(bench, [2.0, 10.0], [60.0], "pattern-search", 100_000, 0)
    next(endless)
    assert threading.active_count() > before
    endless.close()
    until = time.monotonic() + 30.0
    while threading.active_count() > before:
        assert time.monotonic() < until
        time.sleep(0.05)


def test_stl_has_the_rods_in_millimetres(bench) -> None:
    found = bench.stl([2.0, 10.0], [60.0], 0)
    (count,) = np.frombuffer(found[80:84], "<u4")
    facets = np.frombuffer(
        found[84:], np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")])
    )
    assert len(facets) == count
    a, b, c = facets["c"].astype(float).transpose(1, 0, 2)
    volume = np.einsum("fi,fi->", a, np.cross(b, c)) / 6.0
    model = bench.model
    from flexor.scene import scene

    rods = [each for each in scene(model.equilibrium()).objects if each.kind == "rod"]
    assert volume == pytest.approx(1e9 * sum(each.volume(0) for each in rods), rel=1e-4)


def test_a_model_without_design_has_loads_only() -> None:
    text = flexor.load("tendon-arm").file.to_toml()
    model = flexor.load(parse(text))
    bench = workbench(model)
    assert bench.describe()["variables"] == []
    loads = [each["start"] for each in bench.describe()["loads"]]
    assert bench.solve([], loads)["design"]["scene"]["objects"]
    with pytest.raises(flexor.InputError, match="nothing varies"):
        bench.problem_at(loads)


def test_a_design_that_snaps_is_shown_with_its_snap() -> None:
    """Its plot is that of a joint that slides, and its largest value the one furthest away."""
    bench = workbench(flexor.load("truss"))
    shown = bench.solve([], [0.4])["design"]
    assert [event["text"] for event in shown["events"]] == ["snap at 0.3019 N"]
    assert shown["verdict"]["snaps"] == 1
    (plot,) = shown["plots"]
    assert (plot["title"], plot["unit"]) == ("Displacements", "mm")
    (row,) = [each for each in shown["table"] if each["name"] == "angle.apex"]
    assert row["largest"] == row["values"][-1] == "-43.99 mm"
    assert bench.solve([], [0.3])["design"]["verdict"]["snaps"] == 0


def test_bad_requests_are_one_sentence(running) -> None:
    for name, body, words in [
        ("solve", {"values": [2.0, 10.0]}, "incomplete"),
        ("solve", {"values": [2.0], "loads": [60.0]}, "values are 2 finite numbers"),
        ("solve", {"values": [9.0, 10.0], "loads": [60.0]}, "outside its bounds"),
        ("solve", {"values": ["a", 10.0], "loads": [60.0]}, "no numbers"),
        ("solve", {"values": [2.0, 10.0], "loads": [float("inf")]}, "finite"),
        ("landscape", {"values": [2, 10], "loads": [60], "axes": [0, 0], "points": 5}, "different"),
        ("landscape", {"values": [2, 10], "loads": [60], "axes": [0, 1], "points": 1e6}, "at most"),
        (
            "optimise",
            {"values": [2, 10], "loads": [60], "method": "no", "budget": 1, "seed": 0},
            "unknown method",
        ),
        ("stl", {"values": [2, 10], "loads": [60], "step": 99}, "steps"),
        ("stl", {"values": [2, 10], "loads": [60], "step": float("inf")}, "incomplete"),
        ("solve", {"values": 2.0, "loads": [60.0]}, "values are 2 finite numbers"),
        ("landscape", {"values": [2, 10], "loads": [60], "axes": 1, "points": 5}, "incomplete"),
        ("share", {"designs": [{"title": "a", "values": [2, 10]}]}, "incomplete"),
        ("nothing", {}, 'there is no "nothing"'),
        ("solve", [], "JSON object"),
    ]:
        status, text = ask(running.port, name, body)
        assert status == 400, name
        assert words in json.loads(text)["error"]


def test_a_defect_is_not_blamed_on_the_request(running, bench, monkeypatch, capfd) -> None:
    def broken(*_: object) -> None:
        raise TypeError("'float' object is not subscriptable")

    monkeypatch.setattr(type(bench), "design", broken)
    status, text = ask(running.port, "solve", {"values": [2.0, 10.0], "loads": [60.0]})
    assert status == 500
    assert json.loads(text)["error"].startswith("a defect of Flexor: TypeError(")
    assert "Traceback" in capfd.readouterr().err


@pytest.mark.parametrize(
    "body",
    [
        b"[" * 100_000 + b"]" * 100_000,
        b'{"values":' + b"[" * 900 + b"]" * 900 + b"}",
        b"\xff",
        b"{",
    ],
)
def test_bodies_that_are_no_request_are_answered(running, body) -> None:
    """And the connection is not dropped: the next request on it is answered, too."""
    connection = http.client.HTTPConnection("127.0.0.1", running.port, timeout=60)
    for _ in range(2):
        connection.request("POST", "/api/solve", body, {"Content-Type": "application/json"})
        answer = connection.getresponse()
        assert answer.status == 400
        assert "the request" in json.loads(answer.read())["error"]
    connection.close()


@pytest.mark.parametrize(
    "option", [("--parameters", "R01"), ("--subject-to", "strain <= 0.3"), ("--without", "overlap")]
)
def test_a_statement_without_variables_is_refused(option, capsys) -> None:
    """The truss states no design."""
    with pytest.raises(SystemExit) as ended:
        main(["studio", "truss", *option, "--no-open", "--port", "0"])
    assert ended.value.code == 2
    assert "error: " in capsys.readouterr().err


def test_another_site_cannot_ask(running) -> None:
    body = {"values": [2.0, 10.0], "loads": [60.0]}
    assert ask(running.port, "solve", body)[0] == 200
    assert ask(running.port, "solve", body, Host="evil.example:80")[0] == 403
    status, text = ask(running.port, "solve", body, **{"Content-Type": "text/plain"})
    assert status == 400
    assert "JSON" in json.loads(text)["error"]


def test_other_machines_need_the_token(bench, monkeypatch) -> None:
    studio = serve(bench, "0.0.0.0").start()
    try:
        token = studio.url.partition("token=")[2]
        assert len(token) > 20
        body = {"values": [2.0, 10.0], "loads": [60.0]}
        assert ask(studio.port, "solve", body)[0] == 403
        assert ask(studio.port, "solve", body, Authorization="Bearer wrong")[0] == 403
        assert ask(studio.port, "solve", body, Authorization=f"Bearer {token}")[0] == 200
        for query, expected in (("", 403), ("?token=wrong", 403), (f"?token={token}", 200)):
            connection = http.client.HTTPConnection("127.0.0.1", studio.port, timeout=60)
            connection.request("GET", f"/{query}")
            answer = connection.getresponse()
            assert answer.status == expected
            assert (token.encode() in answer.read()) is False
            connection.close()
    finally:
        studio.stop()


def test_tabs_do_not_disturb_each_other(running) -> None:
    answers: dict[float, bytes] = {}

    def solve(wall: float) -> None:
        for _ in range(3):
            answers[wall] = ask(running.port, "solve", {"values": [wall, 10.0], "loads": [60.0]})[1]

    walls = (1.6, 2.0, 2.4)
    threads = [threading.Thread(target=solve, args=(wall,)) for wall in walls]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for wall in walls:
        found = json.loads(answers[wall])["design"]
        alone = json.loads(
            ask(running.port, "solve", {"values": [wall, 10.0], "loads": [60.0]})[1]
        )["design"]
        assert found["table"] == alone["table"]
        assert found["parameters"][0][1] == pytest.approx(wall)


def test_streams_end_when_the_reader_hangs_up(running) -> None:
    before = threading.active_count()
    request = {"values": [2, 10], "loads": [60], "method": "auto", "budget": 100_000, "seed": 0}
    connection = http.client.HTTPConnection("127.0.0.1", running.port, timeout=60)
    connection.request(
        "POST", "/api/optimise", json.dumps(request), {"Content-Type": "application/json"}
    )
    answer = connection.getresponse()
    assert json.loads(answer.readline()) is not None
    connection.close()
    answer.close()
    until = time.monotonic() + 60.0
    while threading.active_count() > before:
        assert time.monotonic() < until
        time.sleep(0.1)


def test_a_port_in_use_is_one_sentence(capsys) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(SystemExit) as ended:
            main(["studio", "pneumatic-finger", "--port", str(port), "--no-open"])
    assert ended.value.code == 2
    message = capsys.readouterr().err
    expected = f"port {port} of 127.0.0.1 is in use: give another with --port, or end what uses it."
    assert message == f"error: {expected}\n"


def test_notebooks_show_it_in_a_frame(running) -> None:
    assert running._repr_html_().startswith(f'<iframe src="{running.url}"')
