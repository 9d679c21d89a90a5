"""Frames have what the results have."""

import os
import pathlib
import types

import figures_test
import numpy as np
import plan_test
import pytest
import study_test

import pinode
from pinode import frames

pandas = pytest.importorskip("pandas")

DATA = pathlib.Path(os.environ["PINODE_SOURCE_DIR"]) / "data"


def test_of_a_fit(baseline):
    frame = baseline.to_pandas()
    assert frame.loc["k1", "value"] == baseline["k1"]
    record = baseline.to_pandas("healthy")
    assert record["a1", "measured"].shape == (1500,) and record.index.name == "time"
    assert np.array_equal(record["a2", "before"], baseline.before()["a2"])
    for key in ("measured", "predicted", "deviation"):
        assert np.array_equal(record["a2", key],
                              getattr(baseline.record("healthy"), key)["a2"])
    assert len(baseline.to_pandas("history")) == len(baseline.history["cost"])
    assert len(baseline.to_pandas("modes")) == 3
    stages = baseline.to_pandas("stages")
    assert list(stages["free_run_error"]) == [
        s["free_run_error"] for s in baseline.json["solver"]["stages"]]
    shapes = baseline.to_pandas("mode_shapes")
    assert list(shapes.index) == ["u1", "u2", "u3"] and shapes.index.name == "dof"
    assert list(shapes.columns) == [(m, which) for m in (1, 2, 3)
                                    for which in ("initial", "updated")]
    assert shapes[2, "updated"].abs().max() == 1.0
    for name in ("changes", "equations", "pareto", "profiles", "forces", "loops", "ambient"):
        assert len(baseline.to_pandas(name)) == 0
    with pytest.raises(pinode.Error, match="no record 'nowhere'"):
        baseline.to_pandas("nowhere")
    with pytest.raises(pinode.Error, match="a frame of a int, expected a name"):
        baseline.to_pandas(3)


def test_of_a_verdict(damaged, baseline, monkeypatch):
    damage = damaged.damage([baseline])
    frame = damage.to_pandas("changes")
    assert list(frame.index) == ["k1", "k2", "k3"] and set(frame["target"]) == {"stiffness"}
    assert frame.loc["k1", "lower95"] == damage.groups["k1"]["lower95"]
    assert frame.loc["k1", "probability"] == 1.0
    mass = {"place": "u2", "change": 0.1, "lower95": 0.05, "upper95": 0.15, "reason": "formal"}
    term = {"name": "k3.hardening", "share": 0.2, "lower95": 0.1, "upper95": 0.3}
    monkeypatch.setattr(damage, "_found", {
        **damage.damage_json, "masses": [mass], "nonlinearity": {"terms": [term]}})
    frame = damage.to_pandas("changes")
    assert frame.loc["mass at u2", "reason"] == "formal"
    assert list(frame["change"])[3:] == [0.1, 0.2]
    assert list(frame["target"])[3:] == ["mass", "nonlinear"]


def test_of_networks_and_their_equations():
    fit = study_test.oscillator(
        networks=[pinode.Network("nn", ["x[u1]", "v[u1]"], ["u1"], layers=[8])],
        options={"max_iterations": 60}).identify()
    loops = fit.to_pandas("loops").loc["nn", "u1", "free"]
    assert np.array_equal(loops["rate"], fit.loops[0]["rate"])
    assert list(loops.columns) == ["time", "deformation", "rate", "force"]
    found = fit.discover()
    terms = found.to_pandas("equations")
    assert terms.loc[("u1", "x[u1]^3"), "coefficient"] == found.terms["u1"]["x[u1]^3"]
    pareto = found.to_pandas("pareto")
    (equation,) = found.equations
    assert list(pareto.loc["u1"].index) == [p["terms"] for p in equation["pareto"]]
    assert list(pareto.index[pareto["chosen"]]) == [("u1", 1)]
    spring = {**fit.loops[0], "rate": np.array([])}
    assert frames.frame(types.SimpleNamespace(loops=[spring]), "loops")["rate"].isna().all()


def test_of_profiles(healthy):
    fit = healthy.replace(profiles={"parameters": ["k1", "k2"]}).identify()
    frame = fit.to_pandas("profiles")
    for name in ("k1", "k2"):
        assert list(frame.loc[name, "value"]) == list(fit.profiles[name]["values"])
        assert list(frame.loc[name, "likelihood_ratio"]) == list(
            fit.profiles[name]["likelihood_ratios"])


def test_of_forces():
    fit = pinode.read_case(DATA / "three_storey_force" / "impact.toml").identify()
    force = fit.forces["blow"]
    frame = fit.to_pandas("forces")
    assert list(frame.columns) == [("blow", k) for k in ("force", "lower95", "upper95")]
    assert np.array_equal(frame.index, force["time"]) and frame.index.name == "time"
    assert np.array_equal(frame["blow", "upper95"], force["upper95"])
    # Times of two records need not be the same.
    two = {name: {"time": np.array(times), "force": np.array(times), "lower95": np.zeros(2),
                  "upper95": np.ones(2)} for name, times in (("f", [0, 1]), ("g", [1, 2]))}
    frame = frames.frame(types.SimpleNamespace(forces=two), "forces")
    assert list(frame.index) == [0, 1, 2]
    assert np.array_equal(frame["g", "force"], [np.nan, 1, 2], equal_nan=True)


def test_of_ambient_spectra():
    outcome = types.SimpleNamespace(ambient={"wind": figures_test.ambient_score("wind")})
    frame = frames.frame(outcome, "ambient")
    assert list(frame.index) == [1.0, 2.0] and frame.index.name == "frequency_hz"
    assert list(frame["wind", "a1", "measured"]) == [1.0, 100.0]
    assert list(frame["wind", "a2", "modelled"]) == [1.0, 1.0]


def test_of_identified_modes():
    modes = pinode.identify_modes(DATA / "three_storey_ambient" / "three_storey_ambient.toml")
    shapes = modes.to_pandas("shapes")
    assert list(shapes.index) == modes.places
    assert np.array_equal(shapes[3, "imaginary"], modes[2]["shape"].imag)
    assert np.array_equal(shapes[1, "sigma_real"], modes[0]["shape_sigma_real"])
    poles = modes.to_pandas("diagram")
    assert len(poles) == sum(len(band["order"]) for band in modes.diagram)
    assert set(poles["mode"]) == {0, 1, 2, 3} and set(poles["record"]) == {"wind"}
    near = poles.loc[poles["mode"] == 1, "frequency_hz"].median()
    assert near == pytest.approx(modes.frequencies_hz[0], rel=0.01)
    with pytest.raises(pinode.Error, match="'poles', expected modes, shapes or diagram"):
        modes.to_pandas("poles")


def test_of_a_plan():
    plan = plan_test.planned(durations=[5.0]).plan_sensors(2)
    sensors = plan.to_pandas()
    assert list(sensors.index) == plan.names and list(sensors["worst"]) == [
        s["worst"] for s in plan]
    deviations = plan.to_pandas("deviations")
    assert deviations.loc["k1", "planned"] == plan.deviations["k1"]["planned"]
    assert plan.to_pandas("durations").loc[5.0, "worst"] == plan.durations[0]["worst"]
    assert len(plan_test.planned().plan_sensors(1).to_pandas("durations")) == 0
    with pytest.raises(pinode.Error, match="expected sensors, deviations or durations"):
        plan.to_pandas("nothing")


def test_of_a_simulation(healthy):
    simulation = healthy.simulate()
    frame = simulation.to_pandas()
    assert np.array_equal(frame["a2"], simulation["healthy"]["channels"]["a2"])
    assert np.array_equal(frame.index, simulation["healthy"]["time"])
    assert frame.equals(simulation.to_pandas("healthy"))
    with pytest.raises(pinode.Error, match="no record 'nowhere'"):
        simulation.to_pandas("nowhere")


def test_of_a_check(healthy):
    check = healthy.check()
    frame = check.to_pandas()
    assert list(frame.index) == ["k1", "k2", "k3"]
    assert list(frame["sigma"]) == [e["sigma"] for e in check["expected"]]
    steps = check.to_pandas("steps")
    assert list(steps.index) == ["healthy"] and steps.loc["healthy", "substeps"] >= 1
    model = pinode.Case(pinode.ShearBuilding([1.0], [1.0])).check()
    assert len(model.to_pandas()) == 0 and len(model.to_pandas("steps")) == 0
    with pytest.raises(pinode.Error, match="a frame of 'rows', expected expected or steps"):
        check.to_pandas("rows")
    with pytest.raises(pinode.Error, match="a frame of a dict, expected a result"):
        frames.of_check({})
