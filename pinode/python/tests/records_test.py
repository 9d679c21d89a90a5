"""What a record can say: several measurements of a motion, arrays beside files."""

import numpy as np
import pytest

import pinode

STEP, COUNT = 0.01, 400
TIME = STEP * np.arange(COUNT)
WAVE = np.sin(3.0 * TIME)
MODEL = pinode.ShearBuilding([1.0, 1.0], [100.0, 100.0], damping={"ratios": [0.02, 0.02]})
GROUPS = [pinode.Group("k1", storey=1)]


def case(record, **parts):
    return pinode.Case(MODEL, groups=GROUPS, records=[record], **parts)


def test_several_measurements_of_a_motion():
    """A velocity that is not that of the displacement tells that it is looked at."""
    force = pinode.Channel("f", None, "force", dof="u1")
    damped = pinode.Model(np.eye(1), np.zeros((1, 1)), [[5.0]])

    def load_cell(motion):
        record = pinode.Record("r", step=STEP, motion=motion, interpolation="linear",
                               channels=[force])
        return pinode.Case(damped, records=[record], elements=[pinode.Element(
            "e", "linear", ("ground", "u1"), {"k": pinode.Unknown(1.0)})]
            ).simulate()["r"]["channels"]["f"]

    speed = 7.0 * np.ones(COUNT)
    both = load_cell({"u1": [{"values": WAVE},
                             {"values": speed, "quantity": "velocity"},
                             {"values": 0.0 * WAVE, "quantity": "acceleration"}]})
    assert both == pytest.approx(WAVE + 5.0 * speed)
    one = load_cell({"u1": WAVE})
    assert one[5:-5] == pytest.approx(
        (WAVE + 5.0 * 3.0 * np.cos(3.0 * TIME) - 9.0 * WAVE)[5:-5], rel=1e-2, abs=0.05)


def write(path, **columns):
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",",
               header=",".join(columns), comments="", fmt="%.17g")
    return path


def test_arrays_beside_a_file(tmp_path):
    file = write(tmp_path / "m.csv", t=TIME, a=WAVE, b=2.0 * WAVE)
    channels = [pinode.Channel("a", "a", dof="u1", unit="m/s^2"),
                pinode.Channel("c", 3.0 * WAVE, dof="u2")]
    common = dict(file=file, interpolation="linear", start="rest")
    made = case(pinode.Record("r", step=STEP, ground={"x": 5.0 * WAVE}, channels=channels, **common))
    seen = made.measured("r")
    assert np.array_equal(seen["a"], WAVE) and np.array_equal(seen["c"], 3.0 * WAVE)
    expected = case(pinode.Record("r", step=STEP, ground={"x": 5.0 * WAVE}, channels=[
        pinode.Channel("a", WAVE, dof="u1"), pinode.Channel("c", 3.0 * WAVE, dof="u2")],
        interpolation="linear", start="rest"))
    states = expected.simulate()["r"]["states"]
    assert np.array_equal(made.simulate()["r"]["states"], states)
    # With times of their own, here of a motion that goes on for longer.
    longer = STEP * np.arange(-20, COUNT + 20)
    timed = {"values": 5.0 * np.sin(3.0 * longer), "time": longer}
    made = case(pinode.Record("r", time="t", ground={"x": timed}, channels=channels[:1], **common))
    assert np.allclose(made.simulate()["r"]["states"], states)
    made.save(tmp_path / "saved")
    again = pinode.read_case(tmp_path / "saved" / "case.toml")
    assert np.array_equal(again.simulate()["r"]["states"], made.simulate()["r"]["states"])
    with pytest.raises(pinode.Error, match="expected {'values': ..., 'time': seconds}, or the"):
        pinode.Record("r", time="t", ground={"x": WAVE}, channels=channels, **common)
    with pytest.raises(pinode.Error, match="'ground_x' has a 'time', but the record has a 'step'"):
        pinode.Record("r", step=STEP, ground={"x": timed}, channels=channels, **common)
    with pytest.raises(pinode.Error, match="'a' has both an array and a file"):
        pinode.Record("r", step=STEP, channels=[pinode.Channel("a", WAVE, file=file)])


def test_columns_that_nobody_wants_are_not_looked_at():
    """A row twice, with other numbers of what is not of this record."""
    def twice(values):
        return np.insert(values, 8, values[7])

    other = np.arange(COUNT + 1.0)
    other[3] = np.inf
    columns = {"t": twice(TIME), "a": twice(WAVE), "other": other}
    made = case(pinode.Record("r", file=columns, time="t", channels=[
        pinode.Channel("a", "a", dof="u1")]))
    assert np.array_equal(made.measured("r")["a"], WAVE)


@pytest.mark.parametrize("name", ["t", "ground_x"])
def test_channels_may_be_called_as_columns_are(name):
    channel = pinode.Channel(name, 2.0 * WAVE, dof="u1")
    made = case(pinode.Record("r", time=TIME, ground={"x": WAVE}, interpolation="linear",
                              channels=[channel]))
    assert list(made.records["r"]["channels"]) == [name]
    assert np.array_equal(made.measured("r")[name], 2.0 * WAVE)
    with pytest.raises(pinode.Error, match="this name is used twice in this record, expected different names"):
        case(pinode.Record("r", step=STEP, channels=[channel, channel]))


def test_reference_curves_and_truths_of_arrays(tmp_path):
    x = np.linspace(-1.0, 1.0, 21)
    pandas = pytest.importorskip("pandas")
    record = pinode.Record("r", file={"t": TIME, "a": WAVE, "F": 4.0 * WAVE}, time="t", channels=[
        pinode.Channel("a", "a", dof="u1")])
    keys = dict(
        elements=[pinode.Element("e", "cubic", ("ground", "u1"), {"k3": pinode.Unknown(1.0)})],
        unknown_forces=[pinode.UnknownForce("f", "u2", record="r", window=[0.0, 3.9],
                                            knot_spacing=0.2, scale=1.0, truth="F")])
    curve = {"term": "e", "name": "sheet"}
    for given in ({"deformation": x, "force": x**3}, {"file": {"deformation": x, "force": x**3}},
                  {"file": pandas.DataFrame({"d": x, "f": x**3, "s": "text"}),
                   "deformation": "d", "force": "f"}):
        made = case(record, reference_curves=[{**curve, **given}], **keys)
    other = made.replace(reference_curves=[{**curve, "deformation": x, "force": 2.0 * x}])
    other.save(tmp_path / "saved")
    assert pinode.read_case(tmp_path / "saved/case.toml").parameters == other.parameters
    fit = other.identify(callback=lambda state: False)
    known = fit.loops[0]["known"]
    assert known["name"] == "sheet" and np.array_equal(known["force"], 2.0 * x)
    assert np.array_equal(fit.forces["f"]["truth"]["force"], 4.0 * WAVE)
    with pytest.raises(pinode.Error, match="not a curve"):
        case(record, reference_curves=[{**curve, "deformation": [1.0], "force": [1.0]}], **keys)
