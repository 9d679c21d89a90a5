"""The promise of twenty lines."""

import os
import pathlib
import runpy
import sys
import types

import frame_testing

SCRIPT = pathlib.Path(__file__).with_name("twenty_lines.py")


def lines_of_code(path):
    lines = [line.strip() for line in path.read_text().splitlines()]
    return [line for line in lines if line and not line.startswith("#")]


def test_has_at_most_twenty_lines():
    assert len(lines_of_code(SCRIPT)) <= 20


def test_says_what_is_damaged(tmp_path, monkeypatch, capsys):
    measurements = types.ModuleType("measurements")
    for name in ("DAMPING", "MASS", "STIFFNESS", "STOREYS"):
        setattr(measurements, name, getattr(frame_testing, name))
    measurements.last_year = frame_testing.measure(seed=1)
    measurements.today = frame_testing.measure((0.1, 0.0, 0.0), seed=2)
    monkeypatch.setitem(sys.modules, "measurements", measurements)
    monkeypatch.chdir(tmp_path)
    result = runpy.run_path(str(SCRIPT))
    damage = result["damage"]
    assert damage.verdict == "damage"
    assert "k1" in capsys.readouterr().out
    group = damage.groups["k1"]
    assert group["damaged"]
    assert abs(group["change"] + 0.1) < group["upper95"] - group["lower95"] < 0.01
    assert not damage.groups["k2"]["damaged"]
    pictures = {name for name in os.listdir(tmp_path) if name.endswith(".png")}
    assert {"changes.png", "parameters.png", "prediction_today.png"} <= pictures
    for picture in pictures:
        assert os.path.getsize(tmp_path / picture) > 5000
    assert {"report.html", "damage.json", "result.json", "model.toml"} <= set(
        os.listdir(tmp_path / "frame"))
