"""Folders of every kind are read, and say what they have none of."""

import json
import os
from pathlib import Path

import conftest
import frame_testing
import numpy as np
import pytest
import study_test

import pinode

SOURCE = Path(os.environ["PINODE_SOURCE_DIR"])
AMBIENT = SOURCE / "data/three_storey_ambient/three_storey_ambient.toml"


def refuses(folder, names, kind):
    """None of these is there, and the sentence says what the folder is of."""
    for name in names:
        with pytest.raises(pinode.Error, match=f"no '{name}'; the folder is of .*{kind}"):
            getattr(folder, name)


def test_of_a_check(healthy, tmp_path):
    healthy.check(output=tmp_path / "out")
    folder = pinode.read_result(tmp_path / "out")
    assert folder.kind == "check" and "determined" in folder.message
    modes = healthy.natural_modes()
    assert [m["frequency_hz"] for m in folder.modes] == pytest.approx(modes["frequencies_hz"])
    assert np.allclose(folder.matrix("mode_shapes.mtx"), modes["shapes"])
    assert np.allclose(folder.matrix("K.mtx"), frame_testing.STIFFNESS)
    assert folder.records["healthy"]["samples"] == 1500
    expected = folder.table("expected.csv")
    assert list(expected["name"]) == ["k1", "k2", "k3"] and (expected["sigma"] > 0).all()
    assert list(folder.to_pandas("expected.csv").columns) == ["name", "unit", "initial", "sigma"]
    assert "k2" in folder._repr_html_() and "determined" in repr(folder)
    refuses(folder, ["usable", "parameters", "sensors", "places"], "a check")


def test_of_a_simulation(healthy, tmp_path):
    simulation = healthy.simulate()
    simulation.save(tmp_path / "out")
    folder = pinode.read_result(tmp_path / "out")
    assert folder.kind == "simulation" and folder.records["healthy"]["finite"]
    response = folder.response("healthy")
    assert np.allclose(response["t"], simulation["healthy"]["time"])
    assert np.allclose(response["a3"], simulation["healthy"]["channels"]["a3"])
    with pytest.raises(pinode.Error, match="response_other.csv"):
        folder.response("other")
    with pytest.raises(pinode.Error, match="type int, expected a name"):
        folder.response(3)
    assert "simulation" in repr(folder) and "simulation" in folder._repr_html_()
    refuses(folder, ["usable", "message", "parameters", "modes"], "a simulation")


def test_of_identified_modes(tmp_path):
    found = pinode.identify_modes(AMBIENT, output=tmp_path / "out")
    folder = pinode.read_result(tmp_path / "out")
    assert folder.kind == "modes" and folder.places == found.places
    assert list(folder.records) == ["wind"]
    assert len(folder.modes) == len(found) == 3
    for theirs, ours in zip(folder.modes, found):
        assert theirs["frequency_hz"] == pytest.approx(ours["frequency_hz"])
        for key in ("shape", "shape_sigma_real", "shape_sigma_imaginary"):
            assert np.allclose(theirs[key], ours[key])
    assert len(folder.table("modes.csv")["u3_real"]) == 3
    assert f"{found[0]['frequency_hz']:.4g}" in folder._repr_html_()
    refuses(folder, ["usable", "message", "parameters", "sensors"], "identified modes")


def test_of_a_plan(healthy, tmp_path):
    plan = healthy.plan_sensors(2, output=tmp_path / "out")
    folder = pinode.read_result(tmp_path / "out")
    assert folder.kind == "plan"
    assert [s["name"] for s in folder.sensors] == plan.names
    assert list(folder.table("sensors.csv")["name"]) == plan.names
    assert folder.table("deviations.csv")["planned"][0] == pytest.approx(
        plan.deviations["k1"]["planned"])
    assert plan.names[0] in folder._repr_html_()
    refuses(folder, ["usable", "parameters", "modes", "records"], "a plan")


def test_of_a_fit_and_a_verdict(baseline, damaged, tmp_path):
    baseline.save(tmp_path / "fit")
    fit = pinode.read_result(tmp_path / "fit")
    assert fit.kind == "fit" and fit.damage is None and fit.discovery is None
    with pytest.raises(pinode.Error, match="has no discover.json"):
        fit.equations
    damaged.damage([baseline], output=tmp_path / "damage")
    damage = pinode.read_result(tmp_path / "damage")
    assert damage.kind == "damage" and damage.damage["verdict"] == "damage"


def network(**parts):
    return study_test.oscillator(
        networks=[pinode.Network("nn", ["x[u1]", "v[u1]"], ["u1"], layers=[8])],
        options={"max_iterations": 60}, **parts)


@pytest.mark.parametrize("refit", [True, False])
def test_of_a_discovery(refit, tmp_path):
    found = network(discover={"refit": refit}).identify().discover(output=tmp_path / "out")
    folder = pinode.read_result(tmp_path / "out")
    assert folder.kind == "discovery" and folder.discovery == found.discovery_json
    assert folder.equations == found.equations and folder.terms == found.terms
    (term,) = [t for t in found.equations[0]["terms"] if t["basis"] == "x[u1]^3"]
    assert folder.rivals == found.rivals == found.discovery_json["rivals"]
    assert (term["probability"] > 0.95) if refit else (term["probability"] is None)
    assert "x[u1]^3" in folder._repr_html_()
    assert folder.case.dofs == ["u1"]
    # The program leaves no fit where there was none.
    (tmp_path / "out/result.json").unlink()
    alone = pinode.read_result(tmp_path / "out")
    assert alone.kind == "discovery" and alone.terms == found.terms
    assert "x[u1]^3" in alone._repr_html_()
    refuses(alone, ["parameters", "modes"], "a discovery")


def test_equations_of_a_model_in_a_folder(tmp_path):
    case = network()
    fit = case.identify(output=tmp_path / "fit")
    ours = fit.discover()
    for model in (tmp_path / "fit", str(tmp_path / "fit"), pinode.read_result(tmp_path / "fit"),
                  fit):
        assert case.discover(model=model).terms == ours.terms
    found = case.discover(model=tmp_path / "fit", output=tmp_path / "out")
    assert pinode.read_result(tmp_path / "out").terms == found.terms
    with pytest.raises(pinode.Error, match="folder of the model"):
        case.discover(model=tmp_path / "fit", output=f"{tmp_path}/fit/", overwrite=True)
    with pytest.raises(pinode.Error, match="checkpoint.json"):
        case.discover(model=tmp_path / "nowhere")
    with pytest.raises(pinode.Error, match="model is a value of type int"):
        case.discover(model=3)
    with pytest.raises(pinode.Error, match="networks of a model, expected one"):
        case.discover()
    with pytest.raises(pinode.Error, match="of no use"):
        network(discover={"source": "derivatives"}).discover(model=tmp_path / "fit")
    other = pinode.Case(conftest.model(), groups=conftest.groups(),
                        records=[conftest.record("now")])
    with pytest.raises(pinode.Error, match="checkpoint.json"):
        other.discover(model=tmp_path / "fit")


def test_tables_that_are_none(tmp_path):
    (tmp_path / "check.json").write_text(json.dumps({"schema": "pinode-check-1"}))
    folder = pinode.read_result(tmp_path)
    for text in ("", "a,b\n1\n", "a,b\n1,2,3\n"):
        (tmp_path / "x.csv").write_text(text)
        with pytest.raises(pinode.Error, match="cannot be read as a table"):
            folder.table("x.csv")
    (tmp_path / "x.csv").write_text("a,b\n1,\n,x\n")
    table = folder.table("x.csv")
    assert np.array_equal(table["a"], [1.0, np.nan], equal_nan=True)
    assert list(table["b"]) == ["", "x"]
    (tmp_path / "check.json").write_text(json.dumps({"schema": "pinode-result-1"}))
    with pytest.raises(pinode.Error, match="expected its schema"):
        pinode.read_result(tmp_path)
