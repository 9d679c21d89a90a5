"""One argument of every public constructor and function is wrong: a sentence names it
as Python writes it, and no word of case files.

The seed is fixed, so that the draws are the same in every run. PINODE_FUZZ_EXAMPLES
sets how many there are of each.
"""

import inspect
import os
import random
import re

import frame_testing
import numpy as np
import pytest

import pinode

EXAMPLES = int(os.environ.get("PINODE_FUZZ_EXAMPLES", "40"))
SEED = 20261127
GROUND, FLOORS = frame_testing.measure(samples=60)
STEP = frame_testing.STEP
MASS, STIFFNESS = frame_testing.MASS, frame_testing.STIFFNESS

# Values that no argument takes.
NOWHERE = [object(), 3 + 4j, b"bytes", {1, 2}, lambda: None, Ellipsis]
WRONG = {
    "text": [*NOWHERE, 7, -2.5, True, ["a"], {"a": 1}, np.zeros(3)],
    "number": [*NOWHERE, "a", [1.0], {"a": 1}, True, np.zeros(3), float],
    "parameter": [*NOWHERE, "a", [1.0], True, np.zeros(3)],
    "positive": [*NOWHERE, "a", [1.0], {"a": 1}, True, -1.0, 0, np.zeros(3)],
    "whole": [*NOWHERE, "a", 1.5, [1], {"a": 1}, True, np.zeros(3)],
    "flag": [*NOWHERE, "yes", 2, -1.0, [True], {"a": 1}, np.zeros(3)],
    "names": [*NOWHERE[:3], 7, True, "u1", [object()], [[1.0, "a"]]],
    "values": [*NOWHERE[:3], 7, True, "values", {"a": 1}, [object()]],
    "matrix": [*NOWHERE[:3], 7, True, np.zeros(3), np.zeros((2, 5)), [[1.0], [2.0, 3.0]]],
    "mapping": [*NOWHERE, "a", 7, True, [1.0], np.zeros(3)],
    "trend": [*NOWHERE, "a", 7, [1.0], {"a": 1}, np.zeros(3)],
    "list": [*NOWHERE[:3], "a", 7, True],
    "array": [*NOWHERE[:3], "a", 7, True, {"a": 1}],
    "parts": [*NOWHERE[:3], "a", 7, True, [object()], ["a"], [3]],
    "path": [*NOWHERE, 7.5, [1], {"a": 1}, "a\0b"],
    "record": [*NOWHERE, 7, True, ["r"], {"a": 1}],
}

MODEL = dict(mass=MASS, stiffness=STIFFNESS, damping=frame_testing.DAMPING)


def shaken(**keys):
    return pinode.Record("r", **{
        "step": STEP, "ground": {"x": GROUND}, "interpolation": "cubic", "start": "rest",
        "channels": pinode.channels("a", FLOORS, "absolute_acceleration"), **keys})


def case(**keys):
    return pinode.Case(pinode.Model(**MODEL), **{
        "groups": [pinode.Group("k1", frame_testing.STOREYS[0])], "records": [shaken()], **keys})


def of_case(keyword):
    """Makes a case of a part, so that what its constructor leaves is found."""
    return lambda part: case(**{keyword: [part]})


def stopped(state):
    return state["iteration"] < 1


PARTS = {
    pinode.Model: (pinode.Case, MODEL, {
        "mass": "matrix", "stiffness": "matrix", "damping": "matrix", "dofs": "names",
        "influence": "mapping"}),
    pinode.ShearBuilding: (pinode.Case, dict(masses=[1.0, 1.0], stiffnesses=[9.0, 9.0],
                                             damping="none"), {
        "masses": "values", "stiffnesses": "values", "dampers": "values", "dofs": "names"}),
    pinode.FiniteElementModel: (pinode.Case, dict(mass=MASS, stiffness=STIFFNESS,
                                                  damping={"ratios": [0.02]}), {
        "mass": "matrix", "stiffness": "matrix", "exported_damping": "matrix",
        "remove_dofs": "names", "ground_directions": "mapping",
        "expected_frequencies": "values", "frequency_tolerance": "positive",
        "reduction": "mapping"}),
    pinode.Group: (of_case("groups"), dict(name="k1", matrix=frame_testing.STOREYS[0]), {
        "name": "text", "matrix": "matrix", "adds_to": "text", "between": "names",
        "storey": "whole", "scale": "number", "factor": "number", "initial": "number",
        "lower": "number", "upper": "number", "prior_mean": "number",
        "prior_sigma": "positive", "free": "flag", "follows": "mapping",
        "proportional_to": "text", "present": "number"}),
    pinode.Element: (of_case("elements"), dict(
        name="e", type="cubic", between=["ground", "u1"], parameters={"k3": pinode.Unknown()}), {
        "name": "text", "type": "text", "between": "names", "parameters": "mapping",
        "optional": "flag", "file": "path"}),
    pinode.Library: (of_case("libraries"), dict(
        name="l", inputs=["x[u2]"], output="u2", terms=["x[u2]^2"], acts_as="force"), {
        "name": "text", "inputs": "names", "output": "text", "terms": "list",
        "acts_as": "text", "select": "flag"}),
    pinode.Network: (of_case("networks"), dict(
        name="n", inputs=["x[u3]"], outputs=["u3"], layers=[2]), {
        "name": "text", "inputs": "names", "outputs": "names", "layers": "values",
        "activation": "text", "acts_as": "text", "seed": "whole", "bias": "flag",
        "input_scale": "values", "decay": "number", "free": "flag"}),
    pinode.UnknownForce: (of_case("unknown_forces"), dict(
        name="f", dof="u1", window=[0.0, 0.3], knot_spacing=0.1, scale=100.0, record="r"), {
        "name": "text", "dof": "text", "shape": "text", "record": "text", "window": "values",
        "knot_spacing": "positive", "scale": "positive", "parameters": "mapping",
        "free": "flag"}),
    pinode.Unknown: (lambda part: case(elements=[pinode.Element(
        "e", "cubic", ["ground", "u1"], {"k3": part})]), {}, {
        "initial": "number", "lower": "number", "upper": "number", "prior_mean": "number",
        "prior_sigma": "positive", "free": "flag"}),
    pinode.Channel: (lambda part: case(records=[shaken(channels=[part])]), dict(
        name="a", values=FLOORS[:, 0], quantity="absolute_acceleration", dof="u1"), {
        "name": "text", "quantity": "text", "dof": "text", "combination": "mapping",
        "unit": "text", "sigma": "number", "sigma_percent": "number", "fit": "flag",
        "scale": "number", "sign": "number", "remove_offset": "flag", "gain": "parameter",
        "delay": "parameter", "offset": "parameter"}),
    pinode.Record: (of_case("records"), dict(
        name="r", step=STEP, ground={"x": GROUND}, interpolation="cubic", start="rest",
        channels=pinode.channels("a", FLOORS, "absolute_acceleration")), {
        "name": "text", "channels": "parts", "step": "positive", "ground": "mapping",
        "force": "mapping", "motion": "mapping", "covariate": "mapping",
        "interpolation": "text", "start": "number", "role": "text", "window": "values",
        "resample_hz": "positive", "substeps": "whole", "integrator": "text",
        "periodic": "flag", "filter": "mapping", "excitation": "text"}),
    pinode.Mode: (of_case("modes"), dict(frequency_hz=3.0, frequency_sigma=0.1), {
        "frequency_hz": "positive", "frequency_sigma": "positive", "shape": "number",
        "shape_sigma": "positive", "name": "text"}),
    pinode.Case: (lambda made: made, dict(model=pinode.Model(**MODEL)), {
        "model": "mapping", "groups": "parts", "elements": "parts", "libraries": "parts",
        "networks": "parts", "unknown_forces": "parts", "records": "parts", "modes": "parts",
        "units": "mapping", "options": "mapping", "title": "text", "modal": "mapping",
        "damage": "mapping", "profiles": "mapping", "discover": "mapping",
        "simulate": "mapping", "plan": "mapping", "geometry": "mapping"}),
}
FUNCTIONS = {
    "channels": (lambda: pinode.channels, dict(
        prefix="a", values=FLOORS, quantity="strain"), {
        "prefix": "text", "values": "array", "quantity": "text", "dofs": "names",
        "unit": "text", "sigma": "number"}),
    "identify": (lambda: pinode.identify, dict(
        mass=MASS, stiffness=STIFFNESS, response=FLOORS, ground=GROUND, step=STEP,
        callback=stopped), {
        "mass": "matrix", "stiffness": "matrix", "response": "array", "ground": "number",
        "force": "mapping", "step": "positive", "groups": "parts", "quantity": "text",
        "dofs": "names", "at": "names", "interpolation": "text", "sigma": "number",
        "units": "mapping", "options": "mapping", "callback": "path"}),
    "identify_modes": (lambda: pinode.identify_modes, dict(
        records=FLOORS, step=STEP), {
        "step": "positive", "names": "names", "quantity": "number", "loads": "array",
        "free_decay": "flag", "method": "text", "lowest_hz": "positive",
        "highest_hz": "positive", "block_rows": "whole", "max_order": "whole",
        "max_damping_ratio": "positive", "references": "list", "pick": "list",
        "harmonics": "flag", "detrend": "trend", "filter_hz": "list", "threads": "whole",
        "title": "text", "output": "path", "overwrite": "flag"}),
    "read_case": (lambda: pinode.read_case, dict(path="none.toml"), {
        "path": "path", "simulation": "flag", "planning": "flag"}),
    "read_result": (lambda: pinode.read_result, dict(path="none"), {"path": "path"}),
    "Case.identify": (lambda: case().identify, dict(callback=stopped), {
        "begin_from": "record", "profiles": "flag", "threads": "whole", "progress": "flag",
        "callback": "record", "output": "path", "overwrite": "flag", "resume": "flag",
        "mat": "flag"}),
    "Case.simulate": (lambda: case().simulate, {}, {
        "noise_percent": "number", "noise": "text", "seed": "whole"}),
    "Case.check": (lambda: case().check, {}, {"output": "path", "mat": "flag"}),
    "Case.plan_sensors": (lambda: case().plan_sensors, dict(num_sensors=1), {
        "num_sensors": "whole", "force_at": "text", "output": "path", "mat": "flag"}),
    "Case.damage": (lambda: case().damage, dict(baselines=["none"]), {
        "threshold": "number", "false_alarm_rate": "number", "threads": "whole",
        "progress": "flag", "output": "path"}),
    "Case.discover": (lambda: case().discover, {}, {
        "model": "record", "threads": "whole", "output": "path", "mat": "flag"}),
    "Fit.predict": (lambda: fit().predict, {}, {"record": "record"}),
    "Fit.plot": (lambda: fit().plot, {}, {"record": "record"}),
    "Fit.save": (lambda: fit().save, dict(folder="none"), {
        "folder": "path", "mat": "flag", "deck": "path"}),
}
# Said of callables: what takes a function takes this one.
CALLABLE = {"callback"}
# Tables, headers and keys of case files.
FILE_WORDS = re.compile(r"\[\[|\[(?:model|options|units|modes|damage|plan)\]|\.toml|\w = [\[{'\"]"
                        r"|<\w+[.\[]|case file|header")


def fit():
    if not hasattr(fit, "made"):
        fit.made = case().identify(callback=stopped)
    return fit.made


def misspelt(name, draw):
    """A keyword like another."""
    place = draw.randrange(len(name))
    return draw.choice([name[:place] + name[place + 1:], name + "s", name + "_", "q" + name])


def assert_named(name, work, shown):
    try:
        work()
    except (TypeError, ValueError) as failure:
        text = str(failure)
    else:
        pytest.fail(f"nothing is raised by {shown}")
    assert re.search(rf"(\b|_){name}(\b|_)", text), (shown, text)
    assert not FILE_WORDS.search(text) and "\n" not in text, (shown, text)
    assert len(text) < 600, (shown, text)


def wrong_values(name, kind, draw):
    value = draw.choice(WRONG[kind])
    while name in CALLABLE and callable(value):
        value = draw.choice(WRONG[kind])
    return value


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.__name__)
def test_of_constructors(part):
    use, right, kinds = PARTS[part]
    use(part(**right))  # which is no mistake
    draw = random.Random(f"{SEED} {part.__name__}")
    for _ in range(EXAMPLES):
        name, kind = draw.choice(sorted(kinds.items()))
        value = wrong_values(name, kind, draw)
        shown = f"{part.__name__}({name}={value!r:.60})"
        assert_named(name, lambda: use(part(**{**right, name: value})), shown)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_of_functions(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    function, right, kinds = FUNCTIONS[name]
    call = function()
    draw = random.Random(f"{SEED} {name}")
    for _ in range(EXAMPLES):
        argument, kind = draw.choice(sorted(kinds.items()))
        value = wrong_values(argument, kind, draw)
        shown = f"{name}({argument}={value!r:.60})"
        assert_named(argument, lambda: call(**{**right, argument: value}), shown)


@pytest.mark.parametrize("name", [*(part.__name__ for part in PARTS), *FUNCTIONS])
def test_of_keywords(name):
    """Misspelt ones are named, and most often what was meant is too."""
    parts = {part.__name__: (lambda part=part: part, *PARTS[part][1:]) for part in PARTS}
    function, right, kinds = {**parts, **FUNCTIONS}[name]
    call = function()
    draw = random.Random(f"{SEED} keywords {name}")
    known = [p.name for p in inspect.signature(call).parameters.values()
             if p.kind is not p.VAR_KEYWORD]
    for _ in range(EXAMPLES):
        keyword = misspelt(draw.choice(sorted(kinds)), draw)
        if keyword in known or keyword in kinds or not keyword.isidentifier():
            continue
        with pytest.raises(TypeError, match=rf"keyword.*'{keyword}'") as failure:
            call(**{**right, keyword: 1})
        assert not FILE_WORDS.search(str(failure.value))


def test_all_that_is_public_is_tried():
    """Everything that a user makes or calls; results are made by the package."""
    made = {"Check", "Damage", "Discovery", "Fit", "IdentifiedModes", "Parameter",
            "RecordResult", "ResultFolder", "SensorPlan", "Simulation", "StructureView",
            "Error", "KeywordError", "__version__"}
    tried = {part.__name__ for part in PARTS} | set(FUNCTIONS)
    assert set(pinode.__all__) - made <= tried
