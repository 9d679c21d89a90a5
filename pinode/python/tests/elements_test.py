"""Elements of one's own, compiled for a case."""

import os
import pickle
import shutil

import numpy as np
import pytest
import scipy.integrate

import pinode

pytestmark = pytest.mark.skipif(shutil.which("c++") is None, reason="no compiler of C++")

# k d / (1 + |d| / d0) + f tanh(w / v0)
SOURCE = """
struct Soil {
  template <typename T>
  void operator()(const T* q, const T*, const T* p, T* result) const {
    using std::abs;
    using std::tanh;
    result[0] = p[0] * q[0] / (1.0 + abs(q[0]) / p[1]) + p[2] * tanh(q[1] / 0.05);
  }
};
PINODE_ELEMENTS(library) {
  pinode::AddElement<Soil, 0, 3>(
      "soil", {{"k", 1, -1, 0}, {"d0", 0, 1, 0, 1e-6}, {"f", 1, 0, 0}}, library);
}
"""
MASS, STIFFNESS, DAMPING = 2.0, 200.0, 1.0
TRUTH = {"k": 150.0, "d0": 0.02, "f": 1.5}
STEP = 0.01
TIME = STEP * np.arange(1500)
FORCE = 20.0 * np.sin(9.0 * TIME) + 12.0 * np.sin(4.0 * TIME + 0.3 * TIME**2)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return pinode.elements.build(SOURCE, tmp_path_factory.mktemp("soil") / "soil.so",
                                 include=[os.environ["PINODE_SOURCE_DIR"]])


@pytest.fixture(scope="module")
def displacement():
    """By LSODA."""
    def rate(t, h):
        x, v = h
        soil = TRUTH["k"] * x / (1 + abs(x) / TRUTH["d0"]) + TRUTH["f"] * np.tanh(v / 0.05)
        return [v, (np.interp(t, TIME, FORCE) - STIFFNESS * x - DAMPING * v - soil) / MASS]

    found = scipy.integrate.solve_ivp(rate, (0, TIME[-1]), [0.0, 0.0], "LSODA", TIME,
                                      rtol=1e-10, atol=1e-12, max_step=STEP)
    return found.y[0]


def case(library, displacement, **parameters):
    record = pinode.Record(
        "r", step=STEP, force={"u1": FORCE}, interpolation="linear", start="rest",
        channels=[pinode.Channel("x", dof="u1", quantity="displacement",
                                 values=displacement)])
    return pinode.Case(
        pinode.Model([[MASS]], [[STIFFNESS]], [[DAMPING]], dofs=["u1"]),
        elements=[pinode.Element("soil", "soil", ("ground", "u1"),
                                 {**TRUTH, **parameters}, file=library)],
        records=[record])


def test_runs_as_lsoda_says(library, displacement):
    response = case(library, None).simulate()["r"]["channels"]["x"]
    assert np.abs(response - displacement).max() < 1e-4 * np.abs(displacement).max()


def test_is_identified_written_and_pickled(library, displacement, tmp_path):
    noise = 0.01 * displacement.std() * np.random.default_rng(1).standard_normal(len(TIME))
    unknown = case(library, displacement + noise, k=pinode.Unknown(80.0, lower=0.0),
                   f=pinode.Unknown(0.5))
    fit = pickle.loads(pickle.dumps(unknown)).identify()
    assert fit.usable
    for name in ("k", "f"):
        p = fit.parameters[f"soil.{name}"]
        assert abs(p.value - TRUTH[name]) < 4 * p.sigma and p.sigma < 0.05 * TRUTH[name]
    assert fit.parameters["soil.k"].unit == "N/m"
    fit.save(tmp_path / "out")
    # The updated model names the library from where it stands.
    again = pinode.read_result(tmp_path / "out").case
    assert again.parameters["soil.k"]["value"] == pytest.approx(fit["soil.k"])
    assert again.to_dict()["element"][0]["file"].endswith("soil.so")


def test_is_the_law_that_was_built_last(library, displacement, tmp_path):
    stiffer = str(tmp_path / "soil.so")
    for factor in ("1.0", "3.0"):
        path = pinode.elements.build(SOURCE.replace("p[0] * q[0]", f"{factor} * p[0] * q[0]"),
                                     stiffer, include=[os.environ["PINODE_SOURCE_DIR"]])
        softest = np.abs(case(path, None).simulate()["r"]["channels"]["x"]).max()
        if factor == "1.0":
            assert softest == pytest.approx(np.abs(displacement).max(), rel=1e-3)
    assert softest < 0.95 * np.abs(displacement).max()
    # A fit of the other law is not gone on from.
    unknown = {"k": pinode.Unknown(80.0, lower=0.0)}
    out = tmp_path / "out"
    case(library, displacement, **unknown).identify(output=out, callback=lambda state: False)
    with pytest.raises(pinode.Error, match="another"):
        case(path, displacement, **unknown).identify(output=out, resume=True)


def test_what_is_wrong_is_said(library, displacement, tmp_path):
    with pytest.raises(pinode.Error, match="'stif'"):
        case(library, displacement, stif=3.0)
    with pytest.raises(pinode.Error, match="there is no element 'sand', expected one of 'soil'"):
        pinode.Case(pinode.Model([[1.0]], [[1.0]], dofs=["u1"]),
                    elements=[pinode.Element("s", "sand", ("ground", "u1"), file=library)])
    with pytest.raises(pinode.Error, match="'d0' needs a value"):
        pinode.Case(pinode.Model([[1.0]], [[1.0]], dofs=["u1"]), elements=[
            pinode.Element("s", "soil", ("ground", "u1"), {"k": 1.0, "f": 0.0}, file=library)])
    with pytest.raises(pinode.Error, match="none.so: cannot be opened"):
        case(str(tmp_path / "none.so"), displacement)
    with pytest.raises(pinode.Error, match="cannot compile the elements: source:1:.*error"):
        pinode.elements.build("struct {\n", tmp_path / "bad.so",
                              include=[os.environ["PINODE_SOURCE_DIR"]])
    assert not (tmp_path / "bad.so").exists()
    with pytest.raises(pinode.Error, match="the compiler 'no-c' is not installed"):
        pinode.elements.build(SOURCE, tmp_path / "a.so", compiler="no-c")
    with pytest.raises(pinode.Error, match="is no file"):
        pinode.elements.build(tmp_path / "nowhere.cc", tmp_path / "a.so")
