"""Planning of sensors, against the same by differences in NumPy."""

import itertools
import json
import pickle

import conftest
import frame_testing
import numpy as np
import pytest

import pinode

GROUND, _ = frame_testing.measure(noise=0.0)
SIGMA = 0.05


def planned(**plan):
    load = pinode.Record("load", step=frame_testing.STEP, ground={"x": GROUND},
                         interpolation="cubic", start="rest", channels=[])
    return pinode.Case(
        conftest.model(), groups=conftest.groups(), records=[load],
        plan={"candidate": [{"quantity": "absolute_acceleration", "sigma": SIGMA, "unit": "m/s^2"}], **plan})


def by_differences():
    """Of each floor's accelerometer, the columns d response / d alpha."""
    def response(alphas):
        ones = [pinode.Group(g["name"], matrix, initial=a) for g, matrix, a in
                zip(conftest.groups(), frame_testing.STOREYS, alphas)]
        places = [pinode.Channel(f"u{i}", dof=f"u{i}") for i in (1, 2, 3)]
        case = pinode.Case(conftest.model(), groups=ones, records=[pinode.Record(
            "load", step=frame_testing.STEP, ground={"x": GROUND}, interpolation="cubic",
            start="rest", channels=places)])
        channels = case.simulate()["load"]["channels"]
        return np.array([channels[f"u{i}"] for i in (1, 2, 3)])

    columns = []
    for j in range(3):
        change = 1e-5 * np.eye(3)[j]
        columns.append((response(change) - response(-change)) / 2e-5)
    return np.transpose(columns, (1, 2, 0))  # floors x samples x groups


def test_a_plan_writes_a_folder(tmp_path):
    plan = planned().plan_sensors(2, output=tmp_path / "p")
    found = json.loads((tmp_path / "p" / "plan.json").read_text())
    assert [s["name"] for s in found["sensors"]] == plan.names
    assert found["all_determined"] and found["criterion"] == "determinant"
    lines = (tmp_path / "p" / "deviations.csv").read_text().splitlines()
    assert lines[0] == "name,unit,initial,own,planned,all"
    name, unit, initial, own, reached, _ = lines[1].split(",")
    assert (name, unit, own) == ("k1", "1", "") and float(initial) == 0.0
    assert float(reached) == pytest.approx(plan.deviations["k1"]["planned"])
    assert not (tmp_path / "p" / "durations.csv").exists()


def test_a_plan_is_the_best_of_all_pairs():
    case = planned()
    plan = case.plan_sensors(2)
    assert plan.targets == ["k1", "k2", "k3"] and len(plan) == 2
    slopes = by_differences()

    def covariance(floors):
        return np.linalg.inv(sum(slopes[f].T @ slopes[f] for f in floors) / SIGMA**2)

    pairs = list(itertools.combinations(range(3), 2))
    best = min(pairs, key=lambda p: np.linalg.det(covariance(p)))
    assert set(plan.names) == {f"u{f + 1}" for f in best}
    expected = np.sqrt(np.diag(covariance(best)))
    for name, sigma in zip(plan.targets, expected):
        assert plan.deviations[name]["planned"] == pytest.approx(sigma, rel=1e-3)
        assert plan.deviations[name]["own"] is None
    assert plan[1]["worst"] == pytest.approx(expected.max(), rel=1e-3)
    everywhere = np.sqrt(np.diag(covariance(range(3))))
    assert plan.one_more["worst"] == pytest.approx(everywhere.max(), rel=1e-3)
    assert all(s["sigma"] == SIGMA and s["unit"] == "m/s^2" for s in plan)
    assert not plan.undetermined


def test_what_a_plan_shows():
    plan = planned(durations=[5.0]).plan_sensors(1)
    assert "Sensors: 1 of 3 places" in str(plan) and plan.names[0] in repr(plan)
    assert "<table>" in plan._repr_html_()
    assert plan.durations[0]["duration"] == 5.0
    assert plan.durations[0]["worst"] > plan[0]["worst"]
    assert pickle.loads(pickle.dumps(plan)).names == plan.names


def test_a_case_that_was_measured_can_be_planned_too(healthy):
    plan = healthy.plan_sensors(3)
    assert set(plan.names) == {"u1", "u2", "u3"}
    assert plan.own["worst"] > 0.0 and plan.deviations["k1"]["own"] > 0.0


def test_where_to_hit():
    blow = np.zeros(400)
    blow[10:13] = 2000.0
    record = pinode.Record("blow", step=0.01, force={"u3": blow}, interpolation="linear",
                           start="rest", channels=[])
    case = pinode.Case(conftest.model(), groups=conftest.groups(), records=[record], plan={})
    worst = {dof: case.plan_sensors(2, force_at=dof)[-1]["worst"] for dof in ("u1", "u3")}
    assert worst["u1"] != worst["u3"] and all(np.isfinite(w) for w in worst.values())
    assert case.plan_sensors(2)[-1]["worst"] == worst["u3"]
    tried = case.replace(plan={"excite": ["u1", "u3"]}).plan_sensors(2).by_force_at
    assert {dof: plan[-1]["worst"] for dof, plan in tried.items()} == worst
    assert case.plan_sensors(2).by_force_at == {}


def test_what_cannot_be_planned():
    case = planned()
    for number in (0, -1, 4):
        with pytest.raises(pinode.Error):
            case.plan_sensors(number)
    with pytest.raises(pinode.Error, match="plan"):
        case.identify()
    with pytest.raises(pinode.Error, match="force"):
        case.plan_sensors(1, force_at="u1")
    with pytest.raises(pinode.Error):
        planned(keep="nothing")


def test_figures_show_what_each_sensor_brings():
    plan = planned(keep_own=False).plan_sensors(3)
    (ax,) = plan.figures()["plan"].axes
    for line, key in zip(ax.lines, ("worst", "typical")):
        values = np.array([step[key] for step in plan])
        there = np.isfinite(values)
        assert np.array_equal(line.get_ydata()[there], values[there]) and there.any()
    assert [text.get_text() for text in ax.get_xticklabels()] == [
        f"{i + 1}: {name}" for i, name in enumerate(plan.names)]


def test_figures_show_what_was_simulated():
    places = [pinode.Channel(f"a{i}", dof=f"u{i}") for i in (1, 2, 3)]
    simulation = pinode.Case(conftest.model(), records=[pinode.Record(
        "load", step=frame_testing.STEP, ground={"x": GROUND}, interpolation="cubic",
        start="rest", channels=places)]).simulate()
    axes = simulation.figures()["response_load"].axes
    assert [ax.get_ylabel() for ax in axes] == ["a1", "a2", "a3"]
    for ax, values in zip(axes, simulation["load"]["channels"].values()):
        assert np.array_equal(ax.lines[0].get_ydata(), values)
    assert len(pinode.figures.simulated(simulation, most=2).axes) == 2
    with pytest.raises(pinode.Error, match="no record 'nowhere' in the simulation"):
        pinode.figures.simulated(simulation, "nowhere")
