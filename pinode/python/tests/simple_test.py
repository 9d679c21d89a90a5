"""The simple case, and what a new user asks of a fit."""

import conftest
import frame_testing
import numpy as np
import pytest

import pinode
from pinode import _simple

MASS, STIFFNESS = frame_testing.MASS, frame_testing.STIFFNESS
GROUND, FLOORS = frame_testing.measure((0.1, 0.0, 0.0))
LOSSES = {"k_ground_u1": -0.1, "k_u1_u2": 0.0, "k_u2_u3": 0.0}


@pytest.fixture(scope="module")
def fit():
    return pinode.identify(MASS, STIFFNESS, FLOORS, ground=GROUND, fs=1.0 / frame_testing.STEP,
                           damping=frame_testing.DAMPING, interpolation="cubic")


def test_one_call_finds_the_loss(fit):
    assert fit.verdict == "good" and set(fit.parameters) == set(LOSSES)
    for name, loss in LOSSES.items():
        found = fit.parameters[name]
        assert abs(found.value - loss) < 4.0 * found.sigma + 1e-3


def test_errors_of_a_fit_speak_of_arguments(fit, tmp_path):
    with pytest.raises(pinode.Error, match="^deck is given, but the model does not come from"):
        fit.save(tmp_path / "result", deck="frame.inp")
    shaken = pinode.Record("n", fs=100, ground={"y": GROUND}, interpolation="linear", start="rest",
                           channels=[pinode.Channel("a", dof="u1")])
    with pytest.raises(pinode.Error, match="^record 'n', ground: 'y' is not a direction"):
        fit.predict(shaken)


def test_damping_that_is_not_known_is_found():
    found = pinode.identify(MASS, STIFFNESS, FLOORS, ground={"x": GROUND},
                            step=frame_testing.STEP)
    dampers = {name.replace("k_", "c_") for name in LOSSES}
    assert set(found.parameters) == {*LOSSES, *dampers, "c_mass"}
    assert found["k_ground_u1"] == pytest.approx(-0.1, abs=1e-3)
    # The truth is 1e-3 of the stiffness before the loss, and nothing by mass.
    case = found.case.to_dict()
    assert case["record"][0]["interpolation"] == "cubic"
    for group, storey in zip([g for g in case["group"] if g["name"] in dampers],
                             frame_testing.STOREYS):
        share = 1e-3 * np.array(storey).max() / np.array(group["matrix"]).max()
        parameter = found.parameters[group["name"]]
        assert abs(parameter.value - (share - 1.0)) < 4.0 * parameter.sigma
        assert parameter.sigma < 0.3


def test_damping_that_the_sensors_do_not_show_has_one_factor():
    found = pinode.identify(MASS, STIFFNESS, FLOORS[:300, [2]], at=["u3"], ground=GROUND[:300],
                            step=frame_testing.STEP, sigma=0.5)
    assert set(found.parameters) == {*LOSSES, "damping"}


@pytest.mark.parametrize("share, chosen", [(0.15, "cubic"), (0.2, "linear")])
def test_the_interpolation_follows_the_load(share, chosen):
    # RMS over that of a line: 0.53 and 0.80, the limit being 0.7.
    load = np.sin(2.0 * np.pi * share * np.arange(400))
    assert _simple._interpolation([load]) == chosen


def test_a_part_of_the_floors_and_groups_of_ones_own():
    found = pinode.identify(
        MASS, STIFFNESS, FLOORS[:, [0, 2]], at=["u1", "u3"], ground=GROUND,
        step=frame_testing.STEP, damping=frame_testing.DAMPING, interpolation="cubic",
        groups={"first": frame_testing.STOREYS[0]})
    assert found["first"] == pytest.approx(-0.1, abs=0.01)


def test_the_springs_are_the_stiffness(fit):
    groups = fit.case.to_dict()["group"]
    assert np.allclose(sum(np.asarray(g["matrix"]) for g in groups), STIFFNESS)


@pytest.mark.parametrize("change, message", [
    ({"response": FLOORS.T}, "response is 3 x 1500, .* pass its transpose, response.T"),
    ({"response": FLOORS[:, :2]}, r"2 channels and the model 3 DOFs, expected at=\[...\]"),
    ({"response": "floors"}, "response is the text 'floors', expected an array of numbers"),
    ({"response": None}, "response is None, expected an array of numbers"),
    ({"ground": None}, "ground and force are both missing.*identify_modes"),
    ({"step": None}, "expected step=seconds, fs=samples a second or time=times"),
    ({"fs": 100.0}, "'step' and 'fs' are given, expected one of them"),
    ({"damping": 2.0}, "damping is the number 2.0, expected a ratio such as 0.02"),
    ({"stiffness": np.ones((3, 3)) + 2.0 * np.eye(3)}, "groups is missing"),
    ({"quantity": "acc"}, "quantity is the text 'acc', expected one of"),
    ({"dt": 0.01}, "no keyword 'dt'; did you mean 'step'"),
    ({"ground": GROUND[:100]}, r"ground\['x'\] 100"),
])
def test_what_is_wrong_is_named(change, message):
    keys = {"mass": MASS, "stiffness": STIFFNESS, "response": FLOORS, "ground": GROUND,
            "step": frame_testing.STEP, **change}
    with pytest.raises(pinode.Error, match=message):
        pinode.identify(**keys)


def test_predicts_a_record_of_the_case(fit):
    shown = fit.predict()
    assert np.array_equal(shown.predicted["y1"], fit.record("record").predicted["y1"])


def test_predicts_a_record_that_it_has_not_seen(fit):
    """The structure has its loss, which the initial model does not have."""
    ground, floors = frame_testing.measure((0.1, 0.0, 0.0), seed=7)
    other = conftest.record("other", (0.1, 0.0, 0.0), seed=7)
    shown = fit.predict(other)
    assert np.array_equal(shown.measured["a3"], floors[:, 2]) and len(shown.time) == len(ground)
    rest = floors[:, 2] - shown.predicted["a3"]
    assert np.std(rest) < 0.03 * np.std(floors[:, 2])
    before = fit.case.replace(record=[other]).simulate()["other"]["channels"]["a3"]
    assert np.std(floors[:, 2] - before) > 5.0 * np.std(rest)
    # Channels need no values.
    sensor = pinode.Record("other", step=frame_testing.STEP, ground={"x": ground}, start="rest",
                           interpolation="cubic", channels=[pinode.Channel("roof", dof="u3")])
    alone = fit.predict(sensor)
    assert alone.measured == {} and np.allclose(alone.predicted["roof"], shown.predicted["a3"])


def test_what_cannot_be_predicted_is_said(fit):
    with pytest.raises(pinode.Error, match="channels is missing, expected the sensors"):
        fit.predict(pinode.Record("r", step=0.01, ground={"x": GROUND}, start="rest",
                                  interpolation="cubic"))
    with pytest.raises(pinode.Error, match="record is a value of type dict, expected a name or"):
        fit.predict({"name": "r"})
    with pytest.raises(pinode.Error, match="there is no record 'r'"):
        fit.predict("r")


def test_plots_in_one_figure(fit, baseline, damaged):
    pytest.importorskip("matplotlib")
    assert fit.plot().axes and fit.plot("record").axes
    damage = damaged.damage([baseline])
    assert damage.plot().axes[0].get_xlabel() != fit.plot().axes[0].get_xlabel()
    with pytest.raises(pinode.Error, match="there is no record 'r'"):
        fit.plot("r")


def test_without_matplotlib_it_says_what_to_install(fit, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pinode._figure", None)
    with pytest.raises(pinode.Error, match="figures need it: python3 -m pip install matplotlib"):
        fit.plot()
