"""Whatever is passed, it is an exception with a sentence: no abort, no crash.

PINODE_FUZZ_EXAMPLES sets how many examples are tried of each test; 10,000 in
all is what a release is held to.
"""

import copy
import inspect
import os
import pickle
import shutil

import frame_testing
import hypothesis
import matplotlib.pyplot as plt
import numpy as np
import pytest
from hypothesis import strategies as st

import pinode
from pinode import _pinode

EXAMPLES = int(os.environ.get("PINODE_FUZZ_EXAMPLES", "40"))
settings = hypothesis.settings(
    max_examples=EXAMPLES, deadline=None, database=None, derandomize=EXAMPLES <= 1000,
    suppress_health_check=list(hypothesis.HealthCheck))

# What somebody has done wrong, in words; no crash, no SystemError.
EXPECTED = (ValueError, TypeError, OverflowError, KeyError, MemoryError)

numbers = st.one_of(
    st.sampled_from([0, -1, 1, 2, 3, 10**6, -(2**31), 2**31, 2**63, 2**64, 0.0, -0.0, 1.0,
                     -1.0, 1e-308, 1e308, -1e308, 1e-12, 1e12, float("nan"), float("inf"),
                     float("-inf"), True, False]),
    st.floats(), st.integers(-5, 50))
texts = st.one_of(
    st.sampled_from(["", "u1", "u2", "ground", "x", "rest", "free", "none", "stiffness", "mass",
                     "x[u1]", "x[u1]^3", "x[u1", "d[ground,u1]", "t", "k1", "\0", "\ud800",
                     "<model.mass>", "<record[0].file>", "a/b", "..", "record", "cubic",
                     "bouc_wen", "linear", "held", "band_limited", "holdout", "ambient",
                     "displacement", "absolute_acceleration", "strain", "m", "mm", "g", "1",
                     "furlong", "craig_bampton", "x" * 5000, "\u00e9\n\t\""]),
    st.text(max_size=8))
shapes = st.sampled_from([(), (0,), (1,), (2,), (3,), (40,), (0, 0), (1, 1), (2, 2), (2, 3),
                          (3, 3), (3, 40), (40, 3), (1, 2, 3)])
dtypes = st.sampled_from(["f8", "f4", "i8", "u1", "?", "c16", "O", "U3", "M8[s]", ">f8", "f2"])


@st.composite
def arrays(draw):
    shape, dtype = draw(shapes), draw(dtypes)
    array = np.zeros(shape, dtype="f8")
    for _ in range(draw(st.integers(0, 3))):
        if array.size:
            array.flat[draw(st.integers(0, array.size - 1))] = draw(
                st.sampled_from([1.0, -1.0, 3.0, 1e300, np.nan, np.inf]))
    if draw(st.booleans()) and array.ndim == 2 and shape[0] == shape[1]:
        array += np.eye(shape[0])
    with np.errstate(all="ignore"):
        return array.astype(dtype) if dtype != "M8[s]" else np.zeros(shape, dtype)


scalars = st.one_of(numbers, texts, st.none(), arrays(),
                    st.sampled_from([object(), 1j, b"x", {1}, range(3), np.float32(2),
                                     np.int8(1), np.bool_(True), np.str_("u1")]))
values = st.recursive(
    scalars,
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.tuples(inner, inner),
                            st.dictionaries(texts, inner, max_size=3)),
    max_leaves=6)


def example_tree():
    """Something of everything, short enough for thousands of tries."""
    ground, floors = frame_testing.measure(samples=40)
    case = {
        "model": {"dofs": ["u1", "u2", "u3"], "mass": frame_testing.MASS,
                  "stiffness": frame_testing.STIFFNESS, "damping": frame_testing.DAMPING,
                  "influence": {"x": [1.0, 1.0, 1.0]}},
        "units": {"force": "N", "length": "m", "time": "s"},
        "group": [{"name": "k1", "adds_to": "stiffness", "matrix": frame_testing.STOREYS[0],
                   "initial": 0.0, "lower": -0.9, "upper": 2.0, "prior_sigma": 0.3}],
        "element": [{"name": "e", "type": "cubic", "between": ["ground", "u1"],
                     "parameters": {"k3": {"initial": 0.0, "lower": -1e9}}}],
        "library": [{"name": "l", "inputs": ["x[u2]"], "output": "u2",
                     "terms": ["x[u2]^2"], "acts_as": "force"}],
        "network": [{"name": "n", "inputs": ["x[u3]", "v[u3]"], "outputs": ["u3"],
                     "layers": [2], "activation": "tanh", "seed": 1}],
        "record": [{"name": "r", "file": {"ag": ground, "a1": floors[:, 0], "t": 0.01 *
                                          np.arange(40)},
                    "time": "t", "interpolation": "cubic", "start": "rest", "role": "train",
                    "ground": [{"direction": "x", "column": "ag", "unit": "model"}],
                    "channel": [{"name": "a1", "column": "a1", "dof": "u1",
                                 "quantity": "absolute_acceleration", "unit": "m/s^2",
                                 "sigma": 0.05}],
                    "substeps": 1}],
        "mode": [{"frequency": 3.0, "frequency_sigma": 0.1, "shape": {"u1": 0.5, "u3": 1.0},
                  "shape_sigma": 0.1}],
        "options": {"max_iterations": 2, "threads": 1, "seed": 1},
        "simulate": {"noise_percent": 1.0, "seed": 1},
        "damage": {"kinds": ["mass", "nonlinear"]},
        "title": "fuzz",
    }
    return case


def places(tree, prefix=()):
    """All paths into the tree."""
    found = [prefix] if prefix else []
    if isinstance(tree, dict):
        for key, value in tree.items():
            found += places(value, prefix + (key,))
    elif isinstance(tree, list):
        for index, value in enumerate(tree):
            found += places(value, prefix + (index,))
    return found


EXAMPLE = example_tree()
PLACES = places(EXAMPLE)


def put(tree, path, value):
    try:
        for step in path[:-1]:
            tree = tree[step]
        tree[path[-1]] = value
    except (KeyError, IndexError, TypeError):
        pass


def is_sentence(failure):
    text = str(failure)
    assert text and "Traceback" not in text
    # Several lines are pybind11's, or those of a name that was passed.
    assert "\n" not in text.strip() or not isinstance(failure, TypeError)
    if isinstance(failure, pinode.Error):
        assert len(text) > 10


def works_or_says_why(work, *values, **keys):
    """Of functions that open files: what cannot be opened is Python's to say."""
    try:
        work(*values, **keys)
    except EXPECTED + (OSError,) as failure:
        is_sentence(failure)


def try_all(case):
    """Everything that can be asked of a case, briefly."""
    for work in (
            lambda: case.parameters, lambda: case.records, case.natural_modes, case.check,
            lambda: case.simulate(noise_percent=1.0), lambda: repr(case),
            lambda: pickle.loads(pickle.dumps(case)), case.to_toml,
            lambda: case.identify(callback=lambda s: s["iteration"] < 2)):
        try:
            work()
        except EXPECTED as failure:
            is_sentence(failure)


# What was found once.
FOUND = [
    (("library", 0, "terms", 0), "x[u2]*\u00e9"),  # a sentence that was empty
    (("record", 0, "resample_hz"), 14500221.0),  # a quarter of an hour
    (("units", "force"), ""),  # an abort
    (("record", 0, "resample_hz"), 1e-18),  # a number too large for an index
]


@pytest.mark.parametrize("path, value", FOUND)
def test_what_was_found(path, value):
    tree = copy.deepcopy(EXAMPLE)
    put(tree, path, value)
    with pytest.raises(pinode.Error) as failure:
        pinode.Case.from_dict(tree)
    is_sentence(failure.value)


def test_the_example_is_a_case():
    case = pinode.Case.from_dict(EXAMPLE)
    assert case.identify(callback=lambda s: s["iteration"] < 2).records


@settings
@hypothesis.given(st.lists(st.tuples(st.sampled_from(PLACES), values), min_size=1, max_size=2))
def test_cases_with_other_values(changes):
    tree = copy.deepcopy(EXAMPLE)
    for path, value in changes:
        put(tree, path, value)
    try:
        case = pinode.Case.from_dict(tree)
    except EXPECTED as failure:
        is_sentence(failure)
        return
    try_all(case)


# Keys of case files that the example does not have, by where they go.
FURTHER = {
    ("record", 0): ["window", "resample_hz", "sampling_rate_hz", "time_unit", "duration",
                    "filter", "force", "motion", "covariate", "excitation", "ambient",
                    "integrator", "periodic", "start_samples"],
    ("record", 0, "channel", 0): ["combination", "unit", "sign", "sigma_percent",
                                  "remove_offset", "gain", "offset", "delay", "fit",
                                  "gauge_length"],
    ("group", 0): ["between", "storey", "scale", "follows", "present", "free", "prior_mean",
                   "proportional_to", "mode", "modes_from", "ratio", "changed_export",
                   "factor"],
    ("network", 0): ["acts_as", "bias", "skip", "gauge", "decay", "memory", "values",
                     "input_scale", "output_scale", "weights", "free"],
    ("model",): ["support_mass_coupling", "expected_hz", "shear_building",
                 "finite_element", "reduction"],
    ("options",): ["shooting", "segment_samples", "robust_loss", "robust_scale",
                   "derivatives", "covariance", "multistart", "tolerance"],
    (): ["unknown_force", "modal", "discover", "profiles", "reference_curve", "modes"],
}
TABLES = {
    "unknown_force": [{"name": "f", "dof": "u1", "window": [0.0, 0.3], "knot_spacing": 0.1,
                       "scale": 100.0, "record": "r"}],
    "force": [{"dof": "u1", "column": "ag", "unit": "N"}],
    "motion": [{"dof": "u1", "column": "ag", "quantity": "acceleration"}],
    "covariate": [{"name": "T", "column": "ag"}],
    "ambient": {"knots": 1}, "excitation": "ambient", "filter": {
        "type": "lowpass", "corner_hz": 20.0, "order": 2},
    "follows": {"time": "linear", "reference": 0.0},
    "shear_building": {"masses": [1.0, 1.0, 1.0], "stiffnesses": [10.0, 10.0, 10.0]},
    "gain": {"initial": 1.0}, "delay": {"initial": 0.0}, "offset": {"initial": 0.0},
    "between": ["ground", "u1"], "combination": {"u1": 1.0, "u2": -1.0},
    "shooting": "single", "derivatives": "jets", "multistart": 2, "robust_loss": "huber",
    "profiles": {"parameters": ["k1"]}, "periodic": True, "window": [0.05, 0.3],
    "resample_hz": 50.0, "discover": {"bags": 2},
}


@settings
@hypothesis.given(st.data())
def test_cases_with_further_keys(data):
    tree = copy.deepcopy(EXAMPLE)
    for _ in range(data.draw(st.integers(1, 3))):
        path = data.draw(st.sampled_from(list(FURTHER)))
        key = data.draw(st.sampled_from(FURTHER[path]))
        usual = key in TABLES and data.draw(st.booleans())
        put(tree, path + (key,), copy.deepcopy(TABLES[key]) if usual else data.draw(values))
        if data.draw(st.booleans()):
            drop = data.draw(st.sampled_from(PLACES))
            put(tree, drop, None)
    try:
        case = pinode.Case.from_dict(tree)
    except EXPECTED as failure:
        is_sentence(failure)
        return
    try_all(case)


PARTS = {
    pinode.Model: ["mass", "stiffness", "damping", "dofs", "influence"],
    pinode.ShearBuilding: ["masses", "stiffnesses", "dampers", "damping", "dofs"],
    pinode.FiniteElementModel: ["mass", "stiffness", "dofs", "remove_dofs", "reduction"],
    pinode.Group: ["name", "matrix", "adds_to", "between", "scale"],
    pinode.Element: ["name", "type", "between", "parameters"],
    pinode.Library: ["name", "inputs", "output", "terms"],
    pinode.Network: ["name", "inputs", "outputs", "layers"],
    pinode.UnknownForce: ["name", "dof", "window", "knot_spacing"],
    pinode.Channel: ["name", "values", "quantity", "dof", "unit"],
    pinode.Record: ["name", "channels", "step", "ground", "interpolation", "file", "time"],
    pinode.Mode: ["frequency_hz", "shape", "dofs"],
}
KEYWORDS = {pinode.Model: "model", pinode.ShearBuilding: "model",
            pinode.FiniteElementModel: "model", pinode.Group: "groups",
            pinode.Element: "elements", pinode.Library: "libraries",
            pinode.Network: "networks", pinode.UnknownForce: "unknown_forces",
            pinode.Channel: None, pinode.Record: "records", pinode.Mode: "modes"}


@settings
@hypothesis.given(st.data())
def test_parts_of_anything(data):
    kind = data.draw(st.sampled_from(list(PARTS)))
    keys = {name: data.draw(values) for name in PARTS[kind]}
    try:
        part = kind(**keys)
        repr(part)
        keyword = KEYWORDS[kind]
        if keyword == "model":
            pinode.Case(part).natural_modes()
        elif keyword is None:
            pinode.Record("r", step=0.1, channels=[part])
        else:
            pinode.Case(pinode.Model(**EXAMPLE["model"]), **{keyword: [part]}).check()
    except EXPECTED as failure:
        is_sentence(failure)


# Long enough for the few orders that are asked for.
WIND = frame_testing.measure(samples=3000)[1][:, :2]


def of_wind(**keys):
    return pinode.identify_modes(
        WIND, **{"step": frame_testing.STEP, "block_rows": 4, "max_order": 6, **keys})


@pytest.fixture(scope="module")
def fit():
    return pinode.Case.from_dict(EXAMPLE).identify(callback=lambda s: s["iteration"] < 3)


def test_folders_without_utf8(fit):
    with pytest.raises(pinode.Error, match="a baseline is"):
        fit.damage(["\ud800"])


@pytest.fixture(scope="module")
def folder(fit, tmp_path_factory):
    path = tmp_path_factory.mktemp("fuzz")
    fit.save(path / "result")
    os.chdir(path)  # whatever is written is written here
    return pinode.read_result("result")


@settings
@hypothesis.given(st.data())
def test_files_of_anything(fit, folder, data):
    case = pinode.Case.from_dict(EXAMPLE)
    work = data.draw(st.sampled_from([
        lambda v: pinode.read_result(v),
        lambda v: pinode.read_case(v),
        lambda v: folder.table(v),
        lambda v: folder.matrix(v),
        lambda v: folder.prediction(v),
        lambda v: folder[v],
        lambda v: case.replace(title=v),
        lambda v: case.replace(records=v),
        lambda v: case.save(v),
        lambda v: fit.save(v),
        lambda v: pinode.Unknown(v),
        lambda v: pinode.Unknown(0.0, lower=v, upper=v),
        lambda v: pinode.figures.prediction(fit, v),
        lambda v: pinode.figures.prediction(fit, "r", most=v),
        lambda v: pinode.frames.frame(fit, v),
        lambda v: pinode.calculix.element_sets(v),
        lambda v: pinode.calculix.export("no.inp", v),
        lambda v: pinode.calculix.export("no.inp", [], factor=v),
        lambda v: pinode.calculix.export(v, ["a"], masses=v),
        lambda v: folder.to_pandas(v),
        lambda v: folder.response(v),
        lambda v: pinode.opensees.read_matrix(v),
        lambda v: pinode.watch.Store(v),
        lambda v: pinode.watch.Store("result/result.json", v),
        lambda v: pinode.identify_modes(v, columns=["a1"]),
        lambda v: case.discover(model=v),
        lambda v: pinode.opensees.read(v, v, dofs={1: [0]}),
        lambda v: pinode.opensees.equation_names(v, 2),
        lambda v: pinode.opensees.equation_names({1: [0, v]}, 2),
    ]))
    # An integer is an open file to Python, of standard input for one.
    value = data.draw(values.filter(lambda v: not isinstance(v, (int, np.integer, np.bool_))))
    works_or_says_why(work, value)


@settings
@hypothesis.given(st.data())
def test_functions_of_anything(fit, data):
    any_value = values
    case = pinode.Case.from_dict(EXAMPLE)
    keys = {"threads": data.draw(any_value)} if data.draw(st.booleans()) else {}
    stop = {"callback": lambda s: s["iteration"] < 1}
    work = data.draw(st.sampled_from([
        lambda v: case.identify(begin_from=v, **stop),
        lambda v: case.identify(profiles=v, **stop),
        lambda v: case.identify(threads=v, **stop),
        lambda v: case.identify(callback=v, **{k: v for k, v in keys.items()}),
        lambda v: case.damage(v, **stop),
        lambda v: case.damage([fit], threshold=v, **stop),
        lambda v: case.damage([fit], false_alarm_rate=v, **stop),
        lambda v: fit.damage(v, **stop),
        lambda v: fit.discover(options=v, **stop),
        lambda v: case.simulate(noise_percent=v),
        lambda v: case.simulate(seed=v),
        lambda v: case.simulate(noise=v),
        lambda v: case.plan_sensors(v),
        lambda v: case.plan_sensors(1, force_at=v),
        lambda v: case.measured(v),
        lambda v: fit.record(v),
        lambda v: fit.before(v),
        lambda v: fit.to_pandas(v),
        lambda v: fit[v],
        lambda v: pinode.identify_modes(v, step=0.1),
        lambda v: of_wind(step=v),
        lambda v: of_wind(names=v),
        lambda v: of_wind(lowest_hz=v),
        lambda v: of_wind(highest_hz=v),
        lambda v: of_wind(block_rows=v),
        lambda v: of_wind(max_order=v),
        lambda v: of_wind(pick=v),
        lambda v: of_wind(references=v),
        lambda v: of_wind(threads=v),
        lambda v: of_wind(quantity=v),
        lambda v: of_wind(loads=v),
        lambda v: of_wind(free_decay=v),
        lambda v: of_wind(method=v),
        lambda v: of_wind(max_damping_ratio=v),
        lambda v: pinode.identify_modes({"record": v}),
        lambda v: pinode.identify_modes({"one": v}, step=0.1),
        lambda v: pinode.channels("a", v, "displacement"),
        lambda v: pinode.Case.read("/nonexistent" + str(v)[:50]),
        lambda v: pinode.Case.from_dict(v),
        lambda v: pinode.Case(v),
        lambda v: _pinode.CaseHandle.from_tree(v, "", "check"),
        lambda v: _pinode.CaseHandle.from_tree(EXAMPLE, v, "check"),
        lambda v: _pinode.CaseHandle.from_tree(EXAMPLE, "", v),
        lambda v: _pinode.FitHandle.from_state(EXAMPLE, "", v),
        lambda v: pinode.opensees.condense(v, v, dofs={1: [0]}),
        lambda v: pinode.opensees.condense(np.eye(2), np.eye(2), dofs=v),
        lambda v: pinode.opensees.condense(np.eye(2), np.eye(2), dofs={1: [0, 1]}, equal=v),
    ]))
    try:
        work(data.draw(any_value))
    except EXPECTED as failure:
        is_sentence(failure)


@pytest.fixture(scope="module")
def modes():
    found = of_wind()
    assert len(found)
    return found


@pytest.fixture(scope="module")
def plan():
    return pinode.Case.from_dict(EXAMPLE).plan_sensors(1)


@pytest.fixture(scope="module")
def simulation():
    return pinode.Case.from_dict(EXAMPLE).simulate()


@settings
@hypothesis.given(st.data())
def test_figures_and_frames_of_anything(fit, modes, plan, simulation, data):
    """Of what is no result, and with any value beside one."""
    results = [fit, modes, plan, simulation]
    figures = [getattr(pinode.figures, name) for name in pinode.figures.__all__]
    frames = [getattr(pinode.frames, name) for name in pinode.frames.__all__]
    draw = data.draw(st.sampled_from(figures + frames))
    outcome = data.draw(st.one_of(st.sampled_from(results), values))
    keys = [name for name in list(inspect.signature(draw).parameters)[1:]]
    given = {name: data.draw(values) for name in keys if data.draw(st.booleans())}
    try:
        draw(outcome, **given)
    except EXPECTED as failure:
        is_sentence(failure)
    finally:
        plt.close("all")


@settings
@hypothesis.given(st.data())
def test_elements_of_anything(folder, data):
    """No compiler is run that would take its time: false(1) fails at once."""
    text = "PINODE_ELEMENTS(library) {}"
    work = data.draw(st.sampled_from([
        lambda v: pinode.elements.build(v, "x.so", compiler="false"),
        lambda v: pinode.elements.build(text, v, compiler="false"),
        lambda v: pinode.elements.build(text, v, compiler="true"),
        lambda v: pinode.elements.build(text, "x.so", include=v, compiler="false"),
        lambda v: pinode.elements.build(text, "x.so", include=[v], compiler="false"),
        lambda v: pinode.elements.build(text, "x.so", compiler=v),
        lambda v: pinode.Element("e", v, ("ground", "u1"), {}, file=v),
        lambda v: pinode.Case(pinode.Model(**EXAMPLE["model"]), elements=[
            pinode.Element("e", "sticky", ("ground", "u1"), {}, file=v)]),
    ]))
    value = data.draw(values.filter(lambda v: not isinstance(v, str) or not shutil.which(v)))
    works_or_says_why(work, value)


@settings
@hypothesis.given(st.data())
def test_folders_of_anything(fit, folder, modes, simulation, data):
    """Where results go, and what is done with what is there; all of it below a
    folder of the test's own."""
    case = pinode.Case.from_dict(EXAMPLE)
    stop = {"callback": lambda s: s["iteration"] < 1}
    work = data.draw(st.sampled_from([
        lambda **keys: case.identify(**stop, **keys),
        lambda **keys: case.damage([fit], **stop, **keys),
        lambda **keys: case.discover(**stop, **keys),
        lambda **keys: fit.discover(**stop, **keys),
        case.check,
        lambda **keys: case.plan_sensors(1, **keys),
        of_wind,
        lambda **keys: fit.save(keys.pop("output", "saved"), **keys),
        lambda **keys: modes.save(keys.pop("output", "saved"), **keys),
        lambda **keys: simulation.save(keys.pop("output", "saved"), **keys),
    ]))
    options = {"output": st.one_of(st.sampled_from(["a", "b/c", "result"]), values),
               "overwrite": st.one_of(st.booleans(), values), "mat": values,
               "resume": st.one_of(st.booleans(), values), "deck": values}
    names = data.draw(st.lists(st.sampled_from(list(options)), max_size=3, unique=True))
    given = {name: data.draw(options[name]) for name in names}
    # A folder of nobody's is not replaced; those of others are not looked at.
    hypothesis.assume(not str(given.get("output", "")).startswith(("/", "..")))
    works_or_says_why(work, **given)
