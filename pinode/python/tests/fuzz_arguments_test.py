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
from pinode import calculix, elements, figures, frames, opensees, watch

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
    "deviations": [*NOWHERE, "a", [1.0], {"a": 1}, {"u1": -1.0}, True, -1.0, 0, np.zeros(3)],
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
    "file": [*NOWHERE, 7.5, [1], "a\0b"],
    "record": [*NOWHERE, 7, True, ["r"], {"a": 1}],
    "damping": [*NOWHERE[:3], 7, True, np.zeros(3), np.zeros((2, 5)), {"ratio": [0.02]}],
    "samples": [*NOWHERE[:3], 7, True, {"a": 1}, np.zeros((4, 2, 2)), [[1.0], [2.0, 3.0]]],
    "callback": [*NOWHERE[:4], "a", 7, [1], {"a": 1}],
    "name": [*NOWHERE, 7, True, ["a"], {"a": 1}],
    "baselines": [*NOWHERE[:3], 7, True, [object()], [3]],
    "tree": [*NOWHERE[:3], "a", 7, True, [1.0]],
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
        "masses": "values", "stiffnesses": "values", "dampers": "values", "damping": "damping",
        "dofs": "names"}),
    pinode.FiniteElementModel: (pinode.Case, dict(mass=MASS, stiffness=STIFFNESS,
                                                  damping={"ratios": [0.02]}), {
        "mass": "matrix", "stiffness": "matrix", "exported_damping": "matrix",
        "damping": "damping", "dofs": "list", "remove_dofs": "names",
        "ground_directions": "mapping",
        "expected_frequencies": "values", "frequency_tolerance": "positive",
        "reduction": "mapping"}),
    pinode.Group: (of_case("groups"), dict(name="k1", matrix=frame_testing.STOREYS[0]), {
        "name": "text", "matrix": "matrix", "adds_to": "text", "between": "names",
        "storey": "whole", "scale": "number", "factor": "number", "initial": "number",
        "lower": "number", "upper": "number", "prior_mean": "number",
        "prior_sigma": "positive", "free": "flag", "follows": "mapping",
         "proportional_to": "text", "mode": "whole", "modes_from": "whole",
         "ratio": "number", "present": "number", "changed_export": "matrix"}),
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
        "activation": "text", "acts_as": "text", "memory": "whole", "values": "values",
        "seed": "whole",
        "bias": "flag", "input_scale": "values", "decay": "number", "free": "flag"}),
    pinode.UnknownForce: (of_case("unknown_forces"), dict(
        name="f", dof="u1", window=[0.0, 0.3], knot_spacing=0.1, scale=100.0, record="r"), {
        "name": "text", "dof": "text", "shape": "text", "record": "text", "window": "values",
        "knot_spacing": "positive", "scale": "positive", "parameters": "mapping",
        "free": "flag"}),
    pinode.Unknown: (lambda part: case(elements=[pinode.Element(
        "e", "cubic", ["ground", "u1"], {"k3": part})]), {}, {
        "initial": "number", "lower": "number", "upper": "number", "prior_mean": "number",
        "prior_sigma": "positive", "free": "flag", "tie": "text", "tie_factor": "number"}),
    pinode.Channel: (lambda part: case(records=[shaken(channels=[part])]), dict(
        name="a", values=FLOORS[:, 0], quantity="absolute_acceleration", dof="u1"), {
        "name": "text", "values": "samples", "quantity": "text", "dof": "text",
        "combination": "mapping",
        "unit": "text", "sigma": "number", "sigma_percent": "number", "fit": "flag",
        "scale": "number", "sign": "number", "remove_offset": "flag", "gain": "parameter",
        "delay": "parameter", "offset": "parameter"}),
    pinode.Record: (of_case("records"), dict(
        name="r", step=STEP, ground={"x": GROUND}, interpolation="cubic", start="rest",
        channels=pinode.channels("a", FLOORS, "absolute_acceleration")), {
        "name": "text", "channels": "parts", "step": "positive", "fs": "positive",
        "sampling_rate_hz": "positive", "time": "samples", "file": "file", "ground": "mapping",
        "force": "mapping", "motion": "mapping", "covariate": "mapping",
        "interpolation": "text", "start": "number", "role": "text", "window": "values",
        "resample_hz": "positive", "substeps": "whole", "integrator": "text",
        "periodic": "flag", "filter": "mapping", "excitation": "text"}),
    pinode.Mode: (of_case("modes"), dict(frequency_hz=3.0, frequency_sigma=0.1), {
        "frequency_hz": "positive", "frequency_sigma": "positive", "shape": "number",
        "shape_sigma": "deviations", "name": "text", "dofs": "names"}),
    pinode.Case: (lambda made: made, dict(model=pinode.Model(**MODEL)), {
        "model": "mapping", "groups": "parts", "elements": "parts", "libraries": "parts",
        "networks": "parts", "unknown_forces": "parts", "records": "parts", "modes": "parts",
        "frfs": "parts",
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
        "force": "mapping", "step": "positive", "fs": "positive",
        "sampling_rate_hz": "positive", "time": "samples", "damping": "damping",
        "start": "number", "progress": "flag", "groups": "parts", "quantity": "text",
        "dofs": "names", "at": "names", "interpolation": "text", "sigma": "number",
        "units": "mapping", "options": "mapping", "callback": "callback"}),
    "identify_modes": (lambda: pinode.identify_modes, dict(
        records=FLOORS, step=STEP), {
        "records": "samples", "step": "positive", "fs": "positive",
        "sampling_rate_hz": "positive", "time": "samples", "columns": "list",
        "time_unit": "text", "time_format": "text", "header_lines": "whole",
        "delimiter": "text", "decimal": "text", "encoding": "text", "scale": "parameter",
        "names": "names", "quantity": "number", "loads": "array",
        "free_decay": "flag", "method": "text", "lowest_hz": "positive",
        "highest_hz": "positive", "block_rows": "whole", "max_order": "whole",
        "max_damping_ratio": "positive", "references": "list", "pick": "list",
        "harmonics": "flag", "detrend": "trend", "filter_hz": "list", "threads": "whole",
        "title": "text", "output": "path", "overwrite": "flag"}),
    "estimate_frfs": (lambda: pinode.estimate_frfs, dict(
        force=FLOORS[:, :1], responses=FLOORS, step=STEP), {
        "force": "array", "responses": "array", "step": "positive", "fs": "positive",
        "sampling_rate_hz": "positive", "names": "names", "references": "list",
        "quantity": "text", "estimator": "text", "excitation": "text", "block": "positive",
        "overlap": "number", "force_window": "positive", "exponential_window": "positive"}),
    "FrequencyResponses.save": (
        lambda: pinode.estimate_frfs(
            FLOORS[:, :1], FLOORS, step=STEP, block=20 * STEP).save,
        dict(path="none.uff"), {"path": "path"}),
    "read_case": (lambda: pinode.read_case, dict(path="none.toml"), {
        "path": "path", "simulation": "flag", "planning": "flag"}),
    "read_result": (lambda: pinode.read_result, dict(path="none"), {"path": "path"}),
    "Case.identify": (lambda: case().identify, dict(callback=stopped), {
        "begin_from": "record", "profiles": "flag", "threads": "whole", "progress": "flag",
        "callback": "callback", "output": "path", "overwrite": "flag", "resume": "flag",
        "mat": "flag"}),
    "Case.simulate": (lambda: case().simulate, {}, {
        "noise_percent": "number", "noise": "text", "seed": "whole"}),
    "Case.sweep": (lambda: case().sweep, dict(load="ground_x", from_hz=1.0, to_hz=2.0, points=3), {
        "load": "text", "from_hz": "number", "to_hz": "number", "amplitude": "number",
        "points": "whole"}),
    "Case.check": (lambda: case().check, {}, {
        "output": "path", "overwrite": "flag", "mat": "flag"}),
    "Case.plan_sensors": (lambda: case().plan_sensors, dict(num_sensors=1), {
        "num_sensors": "whole", "force_at": "text", "output": "path", "overwrite": "flag",
        "mat": "flag"}),
    "Case.damage": (lambda: case().damage, dict(baselines=["none"]), {
        "baselines": "baselines", "threshold": "number", "false_alarm_rate": "number",
        "threads": "whole", "progress": "flag", "callback": "callback", "output": "path",
        "overwrite": "flag", "resume": "flag", "mat": "flag"}),
    "Case.discover": (lambda: case().discover, {}, {
        "model": "record", "threads": "whole", "progress": "flag", "callback": "callback",
        "output": "path", "overwrite": "flag", "resume": "flag", "mat": "flag"}),
    "Case.from_dict": (lambda: pinode.Case.from_dict, lambda: dict(tree=case().to_dict()), {
        "tree": "tree", "path": "text"}),
    "Case.read": (lambda: pinode.Case.read, dict(path="none.toml"), {
        "path": "path", "simulation": "flag", "planning": "flag"}),
    "Case.replace": (lambda: case().replace, {}, {
        "model": "mapping", "groups": "parts", "records": "parts", "title": "text",
        "options": "mapping"}),
    "Case.measured": (lambda: case().measured, dict(record="r"), {"record": "name"}),
    "Case.save": (lambda: case().save, dict(folder="none"), {"folder": "path"}),
    "Fit.predict": (lambda: fit().predict, {}, {"record": "record"}),
    "Fit.plot": (lambda: fit().plot, {}, {"record": "record"}),
    "Fit.before": (lambda: fit().before, {}, {"record": "name"}),
    "Fit.record": (lambda: fit().record, {}, {"name": "name"}),
    "Fit.damage": (lambda: fit().damage, dict(baselines=["none"]), {
        "baselines": "baselines", "threshold": "number", "false_alarm_rate": "number",
        "threads": "whole", "progress": "flag", "callback": "callback"}),
    "Fit.discover": (lambda: fit().discover, {}, {
        "options": "mapping", "threads": "whole", "progress": "flag",
        "callback": "callback", "output": "path", "overwrite": "flag", "resume": "flag",
        "mat": "flag"}),
    "Fit.save": (lambda: fit().save, dict(folder="none"), {
        "folder": "path", "overwrite": "flag", "mat": "flag", "deck": "path"}),
    "Fit.to_pandas": (lambda: fit().to_pandas, {}, {"what": "name"}),
    "Check.to_pandas": (lambda: case().check().to_pandas, {}, {"what": "name"}),
    "SensorPlan.to_pandas": (lambda: case().plan_sensors(1).to_pandas, {}, {
        "what": "name"}),
    "Simulation.save": (lambda: case().simulate().save, dict(folder="none"), {
        "folder": "path", "overwrite": "flag", "mat": "flag"}),
    "Simulation.to_pandas": (lambda: case().simulate().to_pandas, {}, {
        "record": "name"}),
    "IdentifiedModes.mac": (lambda: found().mac, {}, {"other": "record"}),
    "IdentifiedModes.plot": (lambda: found().plot, {}, {
        "what": "name", "record": "name"}),
    "IdentifiedModes.save": (lambda: found().save, dict(folder="none"), {
        "folder": "path", "overwrite": "flag", "mat": "flag"}),
    "IdentifiedModes.to_pandas": (lambda: found().to_pandas, {}, {"what": "name"}),
    "ResultFolder": (lambda: pinode.ResultFolder, dict(path="none"), {"path": "path"}),
    "ResultFolder.matrix": (lambda: folder().matrix, dict(name="K"), {
        "name": "name", "sparse": "flag"}),
    "ResultFolder.prediction": (lambda: folder().prediction, dict(record="r"), {
        "record": "name"}),
    "ResultFolder.response": (lambda: folder().response, dict(record="r"), {
        "record": "name"}),
    "ResultFolder.table": (lambda: folder().table, dict(name="parameters"), {
        "name": "name"}),
    "ResultFolder.to_pandas": (lambda: folder().to_pandas, dict(name="parameters"), {
        "name": "name"}),
    "StructureView.save": (lambda: pinode.StructureView("").save, dict(path="none"), {
        "path": "path"}),
    "calculix.element_sets": (lambda: calculix.element_sets, dict(deck="none.inp"), {
        "deck": "path"}),
    "calculix.export": (lambda: calculix.export, dict(deck="none.inp", sets=["a"]), {
        "deck": "path", "sets": "list", "masses": "list", "factor": "positive",
        "folder": "path", "ccx": "text", "threads": "whole"}),
    "elements.build": (lambda: elements.build, dict(
        source="struct A {};", library="a.so", compiler="none"), {
        "source": "path", "library": "path", "include": "list", "compiler": "text"}),
    "watch.Store": (lambda: watch.Store, dict(path="none.db"), {
        "path": "path", "structure": "name"}),
    "opensees.read_matrix": (lambda: opensees.read_matrix, dict(path="none"), {
        "path": "path"}),
    "opensees.read": (lambda: opensees.read, dict(
        mass="none", stiffness="none", dofs={1: [0]}), {
        "mass": "path", "stiffness": "path", "damping": "path"}),
    "opensees.condense": (lambda: opensees.condense, dict(
        mass=np.eye(1), stiffness=np.eye(1), dofs={1: [0]}), {
        "mass": "matrix", "stiffness": "matrix", "damping": "matrix", "dofs": "tree",
        "equal": "list", "rigid": "list", "coordinates": "tree", "translations": "whole"}),
    "opensees.equation_names": (lambda: opensees.equation_names, dict(
        dofs={1: [0]}, size=1), {"dofs": "tree", "size": "whole"}),
    "frames.frame": (lambda: frames.frame, lambda: dict(
        outcome=fit(), what="parameters"), {
        "what": "name"}),
    "figures.ambient": (lambda: figures.ambient, lambda: dict(outcome=fit()), {
        "most": "whole"}),
    "figures.mode_shapes": (lambda: figures.mode_shapes, lambda: dict(outcome=fit()), {
        "most": "whole"}),
}
# Arguments that stand in for another one.
INSTEAD = {"fs": "step", "sampling_rate_hz": "step", "time": "step"}
# Tables, headers and keys of case files.
FILE_WORDS = re.compile(r"\[\[|\[(?:model|options|units|modes|damage|plan)\]|\.toml|\w = [\[{'\"]"
                        r"|<\w+[.\[]|case file|\bheader\b")


def fit():
    if not hasattr(fit, "made"):
        fit.made = case().identify(callback=stopped)
    return fit.made


def found():
    if not hasattr(found, "made"):
        floors = frame_testing.measure(samples=1000)[1]
        found.made = pinode.identify_modes(floors, step=STEP, block_rows=20)
    return found.made


def folder():
    """The folder of a result; the test's own folder is the current one."""
    fit().save("result", overwrite=True)
    return pinode.read_result("result")


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


def with_wrong(right, name, value):
    """Arguments of which one is wrong; those that it stands in for are left out."""
    left_out = INSTEAD.get(name)
    return {**{key: right[key] for key in right if key != left_out}, name: value}


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.__name__)
def test_of_constructors(part):
    use, right, kinds = PARTS[part]
    use(part(**right))  # which is no mistake
    draw = random.Random(f"{SEED} {part.__name__}")
    for _ in range(EXAMPLES):
        name, kind = draw.choice(sorted(kinds.items()))
        value = draw.choice(WRONG[kind])
        shown = f"{part.__name__}({name}={value!r:.60})"
        assert_named(name, lambda: use(part(**with_wrong(right, name, value))), shown)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_of_functions(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    function, right, kinds = FUNCTIONS[name]
    call, right = function(), right() if callable(right) else right
    draw = random.Random(f"{SEED} {name}")
    for _ in range(EXAMPLES):
        argument, kind = draw.choice(sorted(kinds.items()))
        value = draw.choice(WRONG[kind])
        shown = f"{name}({argument}={value!r:.60})"
        assert_named(argument, lambda: call(**with_wrong(right, argument, value)), shown)


@pytest.mark.parametrize("name", [*(part.__name__ for part in PARTS), *FUNCTIONS])
def test_of_keywords(name, tmp_path, monkeypatch):
    """Misspelt ones are named, and most often what was meant is too."""
    monkeypatch.chdir(tmp_path)
    parts = {part.__name__: (lambda part=part: part, *PARTS[part][1:]) for part in PARTS}
    function, right, kinds = {**parts, **FUNCTIONS}[name]
    call, right = function(), right() if callable(right) else right
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
    made = {"Check", "Damage", "Discovery", "Fit", "FrequencyResponses", "IdentifiedModes",
            "Parameter",
            "RecordResult", "SensorPlan", "Simulation", "StructureView",
            "Error", "KeywordError", "__version__"}
    tried = {part.__name__ for part in PARTS} | set(FUNCTIONS)
    assert set(pinode.__all__) - made <= tried


# Public classes, with methods that have no argument or are another's. Those of
# dictionaries and tuples are Python's.
INHERITED = {"Damage": "Fit", "Discovery": "Fit"}


@pytest.mark.parametrize("name", pinode.__all__)
def test_all_methods_are_tried(name):
    public = getattr(pinode, name)
    if not inspect.isclass(public) or issubclass(public, Exception):
        return
    for method, function in inspect.getmembers(public, callable):
        its_own = method not in dir(dict) and method not in dir(tuple)
        if method.startswith("_") or not its_own:
            continue
        if set(inspect.signature(function).parameters) - {"self"}:
            assert f"{INHERITED.get(name, name)}.{method}" in FUNCTIONS, (name, method)


@pytest.mark.parametrize("name", [*(part.__name__ for part in PARTS), *FUNCTIONS])
def test_all_arguments_are_tried(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    parts = {part.__name__: (lambda part=part: part, *PARTS[part][1:]) for part in PARTS}
    function, _, kinds = {**parts, **FUNCTIONS}[name]
    there = {p.name for p in inspect.signature(function()).parameters.values()
             if p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)}
    # Other arguments than results are refused in wrong_types_test.py.
    assert there - set(kinds) <= {"outcome"}
