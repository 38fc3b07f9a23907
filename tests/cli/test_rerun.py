from __future__ import annotations

import json
import sqlite3

STUDY = ("optimize", "finger", "--parameters", "R01", "--budget", "20", "--out", "study", "--json")


def test_a_study_comes_out_the_same_from_its_folder(flexor, tmp_path) -> None:
    flexor(*STUDY)
    ran = flexor("rerun", "study")
    assert ran.code == 0
    assert ran.out.startswith("Bit-identical: 20 designs re-evaluated in ")
    told = json.loads(flexor("rerun", "study", "--out", "again", "--threads", "1", "--json").out)
    assert told["same"] is True
    assert told["difference"] is None
    assert told["folder"] == "again"
    assert flexor("rerun", "again").code == 0


def test_it_says_what_differs(flexor, tmp_path) -> None:
    flexor(*STUDY)
    path = tmp_path / "study" / "settings.json"
    values = json.loads(path.read_text())
    values["environment"]["numpy"] = "1.0"
    path.write_text(json.dumps(values))
    inside = sqlite3.connect(tmp_path / "study" / "record.sqlite")
    inside.execute("UPDATE evaluations SET iterations = 7 WHERE id = 3")
    inside.commit()
    inside.close()
    ran = flexor("rerun", "study")
    assert ran.code == 1
    assert "First difference: evaluation 3, where iterations was 7 and is now " in ran.out
    assert "The values of the 20 common designs are identical (20 " in ran.out
    assert "numpy" in ran.out
    assert "1.0" in ran.out
    told = json.loads(flexor("rerun", "study", "--json").out)
    assert told["same"] is False
    assert told["difference"]["evaluation"] == 3
    assert [each["what"] for each in told["changed"]] == ["numpy"]


def test_bad_input_gets_one_sentence(flexor) -> None:
    assert "is not a study" in flexor("rerun", "nowhere").error
    flexor(*STUDY)
    assert "holds recorded work already" in flexor("rerun", "study", "--out", "study").error
