"""The page of `flexor share`: complete, safe, small, and the same every time."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import zlib
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import flexor
from flexor.cli.app import main
from flexor.scene import scene
from flexor.study import Study
from flexor.study.sentences import cautions, headline
from flexor.viewer import share_page


class Elements(HTMLParser):
    """Scripts, data and policy of a page, and what else it has."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.scripts: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.data = ""
        self.title = ""
        self._inside = ""
        self.feed(text)

    def handle_starttag(self, tag, attributes) -> None:
        self.tags.append((tag, dict(attributes)))
        self._inside = tag + ("-data" if ("id", "data") in attributes else "")

    def handle_endtag(self, tag) -> None:
        self._inside = ""

    def handle_data(self, data) -> None:
        if self._inside == "script":
            self.scripts.append(data)
        elif self._inside == "script-data":
            self.data += data
        elif self._inside == "title":
            self.title += data

    @property
    def policy(self) -> str:
        return next(a["content"] for t, a in self.tags if t == "meta" and "http-equiv" in a)


@pytest.fixture(scope="module")
def text() -> str:
    return share_page(flexor.load("pneumatic-finger"), "pneumatic-finger.toml")


@pytest.fixture(scope="module")
def page(text) -> Elements:
    return Elements(text)


def decoded(data: dict, key: str) -> np.ndarray:
    entry = data["blobs"][key]
    kinds = {"f": "<f4", "u1": "u1", "u2": "<u2", "u4": "<u4"}
    found = np.frombuffer(zlib.decompress(base64.b64decode(entry["data"])), kinds[entry["type"]])
    assert len(found) == entry["size"]
    return found


def run(*arguments: object) -> int:
    with pytest.raises(SystemExit) as ended:
        main([str(each) for each in arguments])
    return int(ended.value.code or 0)


def test_page_is_small_and_refers_to_nothing(text, page) -> None:
    assert len(text.encode()) < 1_500_000
    for tag, attributes in page.tags:
        assert "src" not in attributes, tag
        assert attributes.get("href", "data:,") == "data:,"
    style = re.findall(r"<style>(.*?)</style>", text, re.DOTALL)[0]
    assert "url(" not in style
    assert "@import" not in style
    assert "Permission is hereby granted, free of charge" in text  # licence of three.js


def test_policy_allows_these_scripts_alone(page) -> None:
    allowed = re.findall(r"script-src ([^;]*)", page.policy)[0].split()
    hashes = [
        f"'sha256-{base64.b64encode(hashlib.sha256(each.encode()).digest()).decode()}'"
        for each in page.scripts
    ]
    assert allowed == hashes
    assert "default-src 'none'" in page.policy
    assert "connect-src 'none'" in page.policy


def test_page_has_the_same_numbers_as_the_path(page) -> None:
    model = flexor.load("pneumatic-finger")
    path = model.equilibrium()
    data = json.loads(page.data)
    (design,) = data["designs"]
    assert design["labels"] == ["0 kPa", "12 kPa", "24 kPa", "36 kPa", "48 kPa", "60 kPa"]
    angles = next(plot for plot in design["plots"] if plot["title"] == "Angles")
    by_name = {each["name"]: each["values"] for each in angles["series"]}
    np.testing.assert_allclose(np.radians(by_name["angle.ph_2"]), path.joint_angles[:, 1])
    table = {row["name"]: row["values"] for row in design["table"]}
    assert table["overlap"][-1] == f"{1e3 * path.max_overlap[-1]:.4g} mm"
    assert [row["text"] for row in design["verdict"]["constraints"]][-1] == "overlap <= 1.5 mm"
    assert ["Flexor", flexor.__version__] in data["provenance"]
    for shown, mesh in zip(design["scene"]["objects"], scene(path).objects, strict=True):
        np.testing.assert_array_equal(decoded(data, shown["faces"]), mesh.faces.ravel())
        if "local" in shown:
            frames = decoded(data, shown["frames"]).reshape(len(path), -1, 3, 4)[-1]
            local = decoded(data, shown["local"]).reshape(-1, 3)
            at = frames[decoded(data, shown["frame"])]
            found = np.einsum("vij,vj->vi", at[:, :, :3], local) + at[:, :, 3]
        else:
            found = decoded(data, shown["positions"]).reshape(len(path), -1, 3)[-1]
        np.testing.assert_allclose(found, mesh.vertices(), atol=1e-7)


def test_colours_give_back_the_field(page) -> None:
    data = json.loads(page.data)
    scale = data["designs"][0]["scene"]["scales"]["strain"]
    path = flexor.load("pneumatic-finger").equilibrium()
    for shown, mesh in zip(
        data["designs"][0]["scene"]["objects"], scene(path).objects, strict=True
    ):
        if "strain" in shown["fields"]:
            codes = decoded(data, shown["fields"]["strain"]).reshape(len(path), -1)
            value = scale["low"] + codes / 254.0 * (scale["high"] - scale["low"])
            np.testing.assert_allclose(value, 100.0 * mesh.fields["strain"], atol=0.13)
    assert scale["unit"] == "%"


WICKED = (
    "</script><script>alert(1)</script> <!--<script> <img src=x onerror=alert(1)> "
    "\"><svg onload=alert(1)> &lt;b&gt; \u2028 ' ]]>"
)


def test_texts_of_files_stay_texts(page) -> None:
    document = flexor.load("pneumatic-finger").file.to_document()
    document["title"] = WICKED
    model = flexor.load(flexor.model.ModelFile.model_validate(document))
    found = Elements(share_page(model, WICKED))
    assert [tag for tag, _ in found.tags] == [tag for tag, _ in page.tags]
    assert found.scripts == page.scripts
    data = json.loads(found.data)
    assert data["title"] == WICKED
    assert ["file", WICKED] in data["provenance"]
    assert found.title == WICKED


def test_many_load_steps_are_thinned_out_below_the_limit(monkeypatch, text) -> None:
    from flexor.viewer import share

    limit = len(text.encode()) + 8_000
    monkeypatch.setattr(share, "LIMIT", limit)
    many = flexor.load("pneumatic-finger", changes={"evaluation.pressure_step": "2 kPa"})
    found = share_page(many)
    data = json.loads(Elements(found).data)
    assert len(found.encode()) < limit
    assert re.fullmatch(r"Every \d+th load step is shown\.", data["note"])
    labels = data["designs"][0]["labels"]
    assert labels[0] == "0 kPa"
    assert labels[-1] == "60 kPa"


def test_a_study_shows_optimum_and_start(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    model = flexor.load("pneumatic-finger")
    bounds = {"exosuit.section.wall": ("1.5 mm", "3 mm")}
    flexor.optimize(model, bounds, "maximise range-of-motion", "grid", folder="wall",
                    tolerance={"exosuit.section.wall": "0.5 mm"},
                    method_options={"points": 3}, budget=4).close()  # fmt: skip
    assert run("share", "wall", "--out", "wall.html") == 0
    data = json.loads(Elements(Path("wall.html").read_text(encoding="utf-8")).data)
    assert [design["title"] for design in data["designs"]] == ["optimum", "start"]
    assert data["designs"][1]["parameters"] == [["exosuit.section.wall", 2.0, "mm"]]
    assert data["designs"][0]["parameters"][0][1] == 2.25  # with a margin for errors
    assert ["seed", "0"] in data["provenance"]
    best, told = Study.open("wall").best, data["designs"][0]["verdict"]
    assert told["headline"] == headline(best.verdict) != ""
    assert [each["text"] for each in told["cautions"]] == cautions(best)
    assert any(text.startswith(("robust: ", "NOT ROBUST: ")) for text in cautions(best))
    assert data["designs"][1]["verdict"]["cautions"] == []
    walls = [
        next(o for o in design["scene"]["objects"] if o["kind"] == "chamber")["local"]
        for design in data["designs"]
    ]
    assert walls[0] != walls[1]  # the section of each design is drawn
    before = Path("wall.html").read_bytes()
    assert run("share", "wall", "--out", "wall.html", "--force") == 0
    assert Path("wall.html").read_bytes() == before


def test_what_cannot_be_written_or_read_is_said(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    Path("there.html").write_text("mine")
    (tmp_path / "folder").mkdir()
    for arguments, words in [
        (("finger", "--out", "there.html"), "--force"),
        (("finger", "--out", "x.pdf"), "must end in .html"),
        (("finger", "--out", "no/x.html"), 'no folder "no"'),
        (("folder", "--out", "x.html"), "folder"),
        (("nobody", "--out", "x.html"), "nobody"),
        (("folder", "--out", "x.html", "--set", "exosuit.length=8 cm"), "--set is for models"),
    ]:
        assert run("share", *arguments) == 2
        message = capsys.readouterr().err
        assert message.startswith("error: ")
        assert words in message
        assert message.count("\n") == 1
    assert Path("there.html").read_text() == "mine"
    assert not Path("x.html").exists()


def test_several_inputs_are_plotted_over_the_steps() -> None:
    model = flexor.load("two-chambers")
    data = json.loads(Elements(share_page(model)).data)
    (design,) = data["designs"]
    steps = len(model.evaluation_loads)
    assert design["loads"] == {"label": "load step", "unit": "", "values": list(range(steps))}
    assert len(design["labels"]) == steps
