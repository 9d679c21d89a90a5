"""Wrong keywords, shapes and kinds are refused where they are given, in the words of
Python; and the keywords are those that the library has."""

import re

import frame_testing
import numpy as np
import pytest

import pinode
from pinode.measurements import INTERPOLATIONS, QUANTITIES, ROLES

NO_KEY = "qqqqqqqqqqqqqqq"


def tree():
    """A case with a table of each kind."""
    ground, floors = frame_testing.measure(samples=40)
    return {
        "model": {"dofs": ["u1", "u2", "u3"], "mass": frame_testing.MASS,
                  "stiffness": frame_testing.STIFFNESS, "damping": frame_testing.DAMPING},
        "group": [{"name": "k1", "adds_to": "stiffness", "matrix": frame_testing.STOREYS[0]}],
        "element": [{"name": "e", "type": "cubic", "between": ["ground", "u1"],
                     "parameters": {"k3": {"initial": 0.0}}}],
        "library": [{"name": "l", "inputs": ["x[u2]"], "output": "u2", "terms": ["x[u2]^2"],
                     "acts_as": "force"}],
        "network": [{"name": "n", "inputs": ["x[u3]"], "outputs": ["u3"], "layers": [2]}],
        "unknown_force": [{"name": "f", "dof": "u1", "window": [0.0, 0.3], "knot_spacing": 0.1,
                           "scale": 100.0, "record": "r"}],
        "record": [{"name": "r", "file": {"ag": ground, "a1": floors[:, 0],
                                          "t": 0.01 * np.arange(40)},
                    "time": "t", "interpolation": "cubic", "start": "rest",
                    "ground": [{"direction": "x", "column": "ag", "unit": "model"}],
                    "channel": [{"name": "a1", "column": "a1", "dof": "u1",
                                 "quantity": "absolute_acceleration", "unit": "m/s^2"}]}],
        "mode": [{"frequency": 3.0, "frequency_sigma": 0.1}],
    }


def known_to_the_library(*path):
    """The keys that the reader of cases has for a table."""
    case = tree()
    table = case
    for step in path:
        table = table[step]
    table[NO_KEY] = 1
    with pytest.raises(pinode.Error, match="known are: ") as failure:
        pinode.Case.from_dict(case)
    return set(str(failure.value).partition("known are: ")[2].split(", "))


# Names here and there, and what is said in another way.
SAME = {"frequency_hz": "frequency", "channels": "channel", "groups": "group",
        "elements": "element", "libraries": "library", "networks": "network",
        "unknown_forces": "unknown_force", "records": "record", "modes": "mode",
        "frfs": "frf",
        "reference_curves": "reference_curve"}
WITHOUT = {"fs", "step", "values"}


@pytest.mark.parametrize("part, path, others", [
    (pinode.Model, ["model"], {"shear_building", "finite_element", "reduction"}),
    (pinode.Group, ["group", 0], set()),
    (pinode.Element, ["element", 0], set()),
    (pinode.Unknown, ["element", 0, "parameters", "k3"], set()),
    (pinode.Library, ["library", 0], set()),
    (pinode.Network, ["network", 0], {"values"}),
    (pinode.UnknownForce, ["unknown_force", 0], {"values"}),
    (pinode.Record, ["record", 0], set()),
    (pinode.Channel, ["record", 0, "channel", 0], set()),
    (pinode.Mode, ["mode", 0], set()),
    (pinode.Case, [], {"modes"}),
], ids=lambda value: getattr(value, "__name__", ""))
def test_keywords_are_those_of_the_library(part, path, others):
    keywords = {SAME.get(k, k) for k in part.__init__.known_keywords} - WITHOUT
    keywords -= {"dofs"} if part is pinode.Mode else set()  # of its shape's entries
    keywords -= {"time"} if part is pinode.Channel else set()  # beside its values
    assert keywords == known_to_the_library(*path) - others


def record(**keys):
    values = np.sin(0.1 * np.arange(200.0))
    return pinode.Record("r", **{
        "step": 0.01, "ground": {"x": values}, "interpolation": "linear", "start": "rest",
        "channels": [pinode.Channel("a", values, dof="u1")], **keys})


def case(**keys):
    return pinode.Case(pinode.Model(np.eye(2), 100.0 * np.eye(2), {"ratios": [0.02]}), **keys)


@pytest.mark.parametrize("call, message", [
    (lambda: pinode.Model(np.eye(2), np.eye(2), 0.02),
     r"^Model: damping is the number 0.02, expected .*\{'ratios': \[0.02\]\}"),
    (lambda: pinode.Model(np.eye(2), np.eye(3)), "^Model: stiffness is 3 x 3, expected 2 x 2"),
    (lambda: pinode.Model(np.eye(2), np.ones((2, 3))), "^Model: stiffness is 2 x 3"),
    (lambda: pinode.Group("k", np.ones(3)), "^Group.'k'.: matrix is an array of 3 numbers, expected n x n"),
    (lambda: pinode.Group("k", adds_to="stifness"),
     "adds_to is the text 'stifness', expected one of .*did you mean 'stiffness'"),
    (lambda: pinode.Group("k", lower="a"), "^Group.'k'.: lower is the text 'a', expected a number"),
    (lambda: pinode.Group(3), "^Group: name is the number 3, expected a text"),
    (lambda: pinode.Element("b", "boucwen", ["ground", "u1"]),
     "^Element.'b'.: type is 'boucwen'; did you mean 'bouc_wen'"),
    (lambda: pinode.Element("b", "cubic", ["ground", "u1"], {"k": 1.0}),
     "^Element.'b'.: parameters has no key 'k'; did you mean|there are k3"),
    (lambda: pinode.Element("b", "coulomb", ["ground", "u1"]),
     "^Element.'b'.: parameters has no 'v0', expected a number"),
    (lambda: pinode.Element("b", "cubic", ["ground", "u1"], {"k3": "stiff"}),
     r"^Element.'b'.: parameters\['k3'\] is the text 'stiff', expected a number"),
    (lambda: pinode.Library("l", ["x[u1]"], "u1", ["x[u1]^3", "x[u1]^^2"]),
     r"^Library.'l'.: terms\[1\]: 'x\[u1\]\^\^2', column 7: .* \(of the inputs x\[u1\]\)"),
    (lambda: pinode.Library("l", ["x[u1]"], "u1", ["v[u1]"]), r"^Library.'l'.: terms\[0\]: "),
    (lambda: pinode.Library("l", ["x[u1]"], "u1", [{"initial": 1.0}]),
     r"^Library.'l'.: terms\[0\] is a value of type dict, expected a function"),
    (lambda: pinode.Unknown(1.0, free="yes"), "free is the text 'yes', expected True or False"),
    (lambda: pinode.Channel("a", np.zeros((3, 200))),
     "values is an array of 3 x 200, expected one number a sample; pinode.channels"),
    (lambda: pinode.Channel("a", quantity="acc"), "quantity is the text 'acc'; there are disp"),
    (lambda: pinode.Channel("a", sigma=-1.0), "sigma is the number -1.0, expected zero or"),
    (lambda: pinode.channels("a", np.zeros((3, 200)), "strain"), "transpose, values.T"),
    (lambda: record(interpolation="lin"), "interpolation is the text 'lin'.*'linear'"),
    (lambda: record(step=None), "expected step=seconds, fs=samples a second or time=times"),
    (lambda: record(fs=100.0), "'step' and 'fs' are given, expected one of them"),
    (lambda: record(step=None, fs=0.0), "fs is the number 0.0, expected a positive number"),
    (lambda: record(ground={"x": np.zeros(10)}),
     r"'a' has 200 values and ground\['x'\] 10, expected one for each sample"),
    (lambda: pinode.Mode(-1.0), "frequency_hz is the number -1.0, expected a positive number"),
    (lambda: pinode.Mode(1.0, shape_sigma="a"),
     "shape_sigma is the text 'a', expected a positive number or a dictionary"),
    (lambda: case(records=[record(start="resting")]), "'start' is 'resting', expected one of rest"),
    (lambda: case(options={"max_iteration": 3}),
     "^options: unknown key 'max_iteration'; did you mean 'max_iterations'"),
    (lambda: case(units={"forc": "N"}), "^units: unknown key 'forc'"),
    (lambda: case(groups=[pinode.Group("k", storey=1)]),
     "^group 'k': 'storey' needs a ShearBuilding; otherwise give 'between' or 'matrix'$"),
    (lambda: case(groups=[pinode.Group("k", changed_export=np.eye(2), factor=2.0)]),
     "^group 'k': an export needs a FiniteElementModel; otherwise"),
    (lambda: pinode.ShearBuilding([1.0, 1.0], [9.0, 9.0], dofs=["a"]),
     "^ShearBuilding: dofs has 1 name and masses 2, expected one for each"),
    (lambda: pinode.ShearBuilding([1.0, 1.0], [9.0, 9.0], dampers=[-1.0, 1.0]),
     r"^ShearBuilding: dampers\[0\] is -1.0, expected zero or a positive number"),
    (lambda: pinode.FiniteElementModel(np.eye(2), np.eye(3)),
     "^FiniteElementModel: stiffness is 3 x 3, expected 2 x 2 as mass is"),
    (lambda: pinode.FiniteElementModel(np.eye(2), np.eye(2), dofs=["a"]),
     "^FiniteElementModel: dofs has 1 name and mass is 2 x 2, expected one for each"),
    (lambda: pinode.Model(np.eye(2), np.eye(2), expected_hz=3.0),
     "^Model: expected_hz is the number 3.0, expected a list or an array of numbers"),
    (lambda: record(ground={"x": None}), r"ground\['x'\] is None, expected one number a sample"),
    (lambda: case(records=[record(ground={"x": ["a"] * 200})]),
     "column 'ground_x', has texts, expected a one-dimensional array of numbers"),
    (lambda: case(groups=[pinode.Group("k", between=["u1", "u2"])],
                  records=[record(step=None, time=0.01 * np.arange(200)[::-1])]),
     r"^records\[0\], sample 2: column 't': time decreases"),
    (lambda: case(units={"length": 1}), "^units: 'length' is the number 1, expected a text$"),
    (lambda: pinode.Case(pinode.Model(np.eye(1), np.eye(1)), records=[record()]),
     r"'damping' is missing, expected a matrix, \{\"rayleigh\": \[a0, a1\]\}"),
])
def test_what_is_wrong_is_named(call, message):
    with pytest.raises(pinode.Error, match=message) as failure:
        call()
    assert not re.search(r"\[\[|\w = [\[{'\"]|<\w+\.", str(failure.value))


@pytest.mark.parametrize("call, message", [
    (lambda: pinode.Model(np.eye(2), np.eye(2), dof=["a", "b"]),
     "^Model.. has no keyword 'dof'; did you mean 'dofs'"),
    (lambda: pinode.Model(M=np.eye(2), K=np.eye(2)), "'M'; did you mean 'mass'"),
    (lambda: pinode.Model(np.eye(2)), "^Model..: missing a required argument: 'stiffness'"),
    (lambda: pinode.Group("k", storeys=1), "'storeys'; did you mean 'storey'"),
    (lambda: pinode.Group("k", colour=1), "no keyword 'colour'; there are name, matrix"),
    (lambda: record(dt=0.01), "'dt'; did you mean 'step'"),
    (lambda: pinode.Channel("a", std=0.1), "'std'; did you mean 'sigma'"),
    (lambda: case(record=[]), "'record'; did you mean 'records'"),
    (lambda: case().replace(record=[]), "'record'; did you mean 'records'"),
])
def test_keywords_are_refused_at_once(call, message):
    with pytest.raises(TypeError, match=message) as failure:
        call()
    assert isinstance(failure.value, pinode.KeywordError)
    assert isinstance(failure.value, pinode.Error)


@pytest.mark.parametrize("key, words", [
    ("interpolation", INTERPOLATIONS), ("role", ROLES)])
def test_words_of_a_record_are_those_of_the_library(key, words):
    wrong = tree()
    wrong["record"][0][key] = NO_KEY
    with pytest.raises(pinode.Error, match="expected one of " + ", ".join(words) + "($|:)"):
        pinode.Case.from_dict(wrong)


def test_quantities_are_those_of_the_library():
    wrong = tree()
    wrong["record"][0]["channel"][0]["quantity"] = NO_KEY
    with pytest.raises(pinode.Error, match="expected one of ") as failure:
        pinode.Case.from_dict(wrong)
    assert set(str(failure.value).partition("one of ")[2].split(", ")) == set(QUANTITIES)


def test_the_rate_is_a_step_or_a_frequency():
    times = [case(groups=[pinode.Group("k1", np.eye(2))], records=[record(**keys)]).measured("r")["time"] for keys in (
        {"step": 0.01}, {"step": None, "fs": 100}, {"step": None, "sampling_rate_hz": 100.0},
        {"step": None, "time": 0.01 * np.arange(200)})]
    for other in times[1:]:
        assert np.allclose(times[0], other)


def test_a_case_from_a_file_keeps_the_words_of_the_file(tmp_path):
    (tmp_path / "case.toml").write_text("[model]\ncolour = 1\n")
    with pytest.raises(pinode.Error, match=r"case.toml:2: \[model\]: unknown key 'colour'"):
        pinode.read_case(tmp_path / "case.toml")


def record_at_rest(**keys):
    return pinode.Record("r", interpolation="cubic", start="rest", **keys)


@pytest.mark.parametrize("make, sentence", [
    (lambda: pinode.ShearBuilding([1, 1], [2, 2], damping={"ratio": [0.02]}),
     "ShearBuilding: damping has no key 'ratio'; did you mean 'ratios'?"),
    (lambda: pinode.Model(np.eye(2), np.eye(2), {"ratios": [0.02], "rayleigh": [1, 1]}),
     "Model: damping has 2 keys, expected one of rayleigh, ratios, diagonal"),
    (lambda: pinode.Unknown(lower=2.0, upper=1.0),
     "Unknown: lower is 2.0 and upper is 1.0, expected lower < upper"),
    (lambda: pinode.Group("k1", storey=1, lower=0.5, upper=0.5),
     "Group('k1'): lower is 0.5 and upper is 0.5, expected lower < upper"),
    (lambda: record_at_rest(fs=100, time=np.arange(5) / 100, ground={"x": np.zeros(5)}),
     "record 'r': time and a sampling rate are given, expected one of them"),
    (lambda: record_at_rest(fs=100, ground={"x": np.zeros((5, 2))}),
     "record 'r': ground['x'] is an array of 5 x 2, expected one number a sample"),
])
def test_values_that_cannot_be_meant_are_refused_by_the_constructor(make, sentence):
    with pytest.raises(pinode.Error) as error:
        make()
    assert str(error.value) == sentence


def test_an_empty_dictionary_of_loads_is_no_load():
    values = np.sin(0.1 * np.arange(200.0))
    made = case(groups=[pinode.Group("k", between=["u1", "u2"])], records=[pinode.Record(
        "r", step=0.01, ground={}, force={"u1": values}, interpolation="linear", start="rest",
        channels=[pinode.Channel("a", values, dof="u1")])])
    assert "ground" not in made.to_dict()["record"][0]


@pytest.mark.parametrize("key, number, found", [
    ("gain", 2.0, lambda plain, other: np.allclose(other, 2.0 * plain)),
    ("offset", 3.0, lambda plain, other: np.allclose(other, plain + 3.0)),
    ("delay", 0.03, lambda plain, other: np.allclose(other[10:], plain[7:-3], atol=0.02)),
])
def test_a_number_for_a_correction_is_fixed(key, number, found):
    def simulated(**keys):
        made = case(records=[record(channels=[pinode.Channel("a", dof="u1", **keys)])])
        assert not any(p["free"] for p in made.parameters.values())
        return made.simulate()["r"]["channels"]["a"]

    plain = simulated()
    assert np.ptp(plain) > 0.1 and found(plain, simulated(**{key: number}))
