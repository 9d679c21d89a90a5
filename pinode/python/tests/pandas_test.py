"""Frames of pandas where arrays may be."""

import conftest
import frame_testing
import numpy as np
import pytest

import pinode

pandas = pytest.importorskip("pandas")
MODEL = pinode.ShearBuilding([1.0, 1.0], [100.0, 100.0], damping={"ratios": [0.02, 0.02]})
STEP, COUNT = 0.01, 400
WAVE = np.sin(0.1 * np.arange(float(COUNT)))


def table(**columns):
    return pandas.DataFrame({"t": STEP * np.arange(COUNT), "ag": WAVE, "a": 2.0 * WAVE, **columns})


def case(file, channels=("a",), **keys):
    record = pinode.Record(
        "r", **{"file": file, "time": "t", "ground": {"x": "ag"}, "interpolation": "linear",
                "channels": [c if isinstance(c, pinode.Channel) else
                             pinode.Channel(c, c, dof="u1") for c in channels], **keys})
    return pinode.Case(MODEL, groups=[pinode.Group("k1", storey=1)], records=[record])


def test_columns_that_nobody_uses_may_be_anything():
    frame = table(remark="fine", kind=pandas.Categorical(["a", "b"] * (COUNT // 2)),
                  when=pandas.date_range("2020-01-01", periods=COUNT, freq="D"), ok=True)
    for file in (frame, {name: frame[name] for name in frame}, {**table(), "remark": "a text"}):
        assert np.array_equal(case(file).measured("r")["a"], 2.0 * WAVE)
    # The truth of a force, which is named elsewhere.
    assert "truth" in pinode.Record("r", file=table(truth=WAVE), time="t", channels=[])["file"]


def test_missing_numbers_of_any_kind():
    for make in (lambda v: pandas.array(v, dtype="Float64"),
                 lambda v: pandas.Series(v, dtype=object),
                 lambda v: pandas.Series([None if x is pandas.NA else x for x in v], dtype=object)):
        values = [pandas.NA if i == 7 else x for i, x in enumerate(2.0 * WAVE)]
        column = make(values)
        for seen in (case(table(b=column), ["b"]).measured("r")["b"],
                     case(table(), channels=[
                         pinode.Channel("b", pandas.Series(column), dof="u1")]).measured("r")["b"]):
            assert np.isnan(seen[7]) and np.array_equal(np.delete(seen, 7),
                                                        np.delete(2.0 * WAVE, 7))
    whole = case(table(b=pandas.array([None, *range(1, COUNT)], dtype="Int64")), ["b"])
    assert np.isnan(whole.measured("r")["b"][0])


@pytest.mark.parametrize("bad", [
    pandas.Series(["x"] * COUNT), pandas.Categorical(["x"] * COUNT),
    pandas.Series([True] * COUNT), pandas.array([True] * COUNT, dtype="boolean"),
    pandas.Series([1.0, "2.0"] * (COUNT // 2), dtype=object)])
def test_columns_that_are_no_numbers_are_refused_where_they_are_used(bad):
    with pytest.raises(pinode.Error, match="column 'b'.*expected a one-dimensional array of num"):
        case(table(b=bad), ["b"])


def test_columns_that_are_not_there_or_several():
    with pytest.raises(pinode.Error, match="no column 'accel'; did you mean 'accele'?"):
        case(table(accele=WAVE), ["accel"])
    with pytest.raises(pinode.Error, match="no column 'zzz'; expected one of t, ag, a"):
        case(table(), ["zzz"])
    with pytest.raises(pinode.Error, match="several columns are called 'a'"):
        case(pandas.concat([table(), table()[["a"]]], axis=1))


def test_dates_are_seconds_from_the_first():
    expected = case(table())
    dates = pandas.Timestamp("2021-03-04 05:06:07") + pandas.to_timedelta(10 * np.arange(COUNT), "ms")
    for when in (dates, dates.tz_localize("Europe/Vienna"), pandas.Series(dates, dtype=object),
                 dates - dates[0], list(dates.to_pydatetime())):
        for given in ({"file": table(t=when)}, {"file": table().drop(columns="t").set_index(
                pandas.Index(when, name="t"))}, {"file": table(), "time": when}):
            seen = case(**given)
            assert np.allclose(seen.measured("r")["time"], expected.measured("r")["time"])
    with pytest.raises(pinode.Error, match="contains texts, expected seconds or dates"):
        case(table(t=[str(d) for d in dates]))
    with pytest.raises(pinode.Error, match="'time_unit' is given, but dates"):
        case(table(t=dates), time_unit="ms")
    with pytest.raises(pinode.Error, match="contains no time"):
        case(table(t=[pandas.NaT] * COUNT))


def test_an_index_with_a_name_is_a_column():
    shaken = pinode.Case(MODEL, records=[pinode.Record(
        "r", step=STEP, ground={"x": WAVE}, interpolation="linear", start="rest",
        channels=[pinode.Channel("a", dof="u1")])])
    frame = shaken.simulate().to_pandas()
    assert frame.index.name == "time"
    frame["ag"] = WAVE
    seen = case(frame, time="time").measured("r")
    assert np.array_equal(seen["a"], frame["a"]) and np.allclose(seen["time"], frame.index)


def test_channels_with_a_frame_of_their_own():
    other = pandas.DataFrame({"t": STEP * np.arange(COUNT), "b": 3.0 * WAVE, "text": "x"})
    seen = case(table(), [pinode.Channel("b", "b", dof="u1", file=other)])
    assert np.array_equal(seen.measured("r")["b"], 3.0 * WAVE)
    seen = case(table(), [pinode.Channel("b", "b", dof="u1", file=other)], time=None, step=STEP)
    assert np.array_equal(seen.measured("r")["b"], 3.0 * WAVE)


def test_matrices_and_the_names_of_their_columns():
    names = ["floor_1", "floor_2", "floor_3"]

    def frame(matrix, columns=names):
        return pandas.DataFrame(matrix, index=columns, columns=columns)

    mass, stiffness, damping = (frame(m) for m in (
        frame_testing.MASS, frame_testing.STIFFNESS, frame_testing.DAMPING))
    made = pinode.Case(pinode.Model(mass, stiffness, damping),
                       groups=[pinode.Group("k1", frame(frame_testing.STOREYS[0]))])
    assert made.dofs == names and np.array_equal(made.stiffness, frame_testing.STIFFNESS)
    assert pinode.Case(pinode.Model(mass, stiffness, dofs=["a", "b", "c"])).dofs == ["a", "b", "c"]
    plain = pinode.Model(pandas.DataFrame(frame_testing.MASS), frame_testing.STIFFNESS)
    assert pinode.Case(plain).dofs == ["u1", "u2", "u3"]
    with pytest.raises(pinode.Error, match="stiffness has columns of other names than mass"):
        pinode.Model(mass, frame(frame_testing.STIFFNESS, names[::-1]))
    with pytest.raises(pinode.Error, match="mass has rows and columns of different names"):
        pinode.Model(mass.iloc[::-1], stiffness)
    building = pinode.ShearBuilding(pandas.Series([1.0, 1.0]), pandas.Series([100.0, 100.0]))
    assert pinode.Case(building).dofs == ["u1", "u2"]
    full = pinode.FiniteElementModel(mass, stiffness, dofs=names)
    assert np.allclose(pinode.Case(full).stiffness, frame_testing.STIFFNESS)


def test_places_of_modes_are_the_columns():
    _, floors = frame_testing.measure(samples=3000)
    frame = pandas.DataFrame(floors, columns=["low", "mid", "top"])
    keys = dict(step=frame_testing.STEP, block_rows=6, max_order=8)
    found = pinode.identify_modes(frame, **keys)
    assert found.places == ["low", "mid", "top"]
    assert np.array_equal(found.shapes, pinode.identify_modes(floors, **keys).shapes)
    assert pinode.identify_modes(frame, names=["a", "b", "c"], **keys).places == ["a", "b", "c"]
    several = pinode.identify_modes({"one": frame, "two": {"values": frame}}, **keys)
    assert several.places == ["low", "mid", "top"]


def test_records_of_a_frame_are_fitted():
    ground, floors = frame_testing.measure()
    frame = pandas.DataFrame({"ag": ground, **{f"a{i}": floors[:, i] for i in range(3)}})
    frame["note"] = "calm"
    record = pinode.Record("r", file=frame, step=frame_testing.STEP, ground={"x": "ag"},
                           interpolation="cubic", start="rest", channels=[
                               pinode.Channel(f"a{i}", f"a{i}", dof=f"u{i + 1}") for i in range(3)])
    fit = pinode.Case(conftest.model(), groups=conftest.groups(), records=[record]).identify()
    assert abs(fit["k1"]) < 0.02


def test_columns_of_a_group_are_the_dofs_in_their_order():
    names = ["roof", "floor"]
    model = pinode.Model(*(pandas.DataFrame(v, index=names, columns=names)
                           for v in (np.diag([1.0, 2.0]), 9.0 * np.eye(2))), {"ratios": [0.02]})
    part = pandas.DataFrame(np.diag([9.0, 0.0]), index=names, columns=names)
    assert pinode.Case(model, groups=[pinode.Group("k", part)]).dofs == names
    turned = part.loc[names[::-1], names[::-1]]
    with pytest.raises(pinode.Error, match=r"groups\[0\]: matrix has the columns floor, roof, "
                                           "expected the DOFs of the model in their order"):
        pinode.Case(model, groups=[pinode.Group("k", turned)])
    with pytest.raises(pinode.Error, match="^Model: stiffness has the columns floor, roof"):
        pinode.Model(np.eye(2), turned, dofs=names)


def test_one_call_takes_names_from_frames():
    ground, floors = frame_testing.measure((0.1, 0.0, 0.0))
    names = ["low", "middle", "roof"]
    mass, stiffness = (pandas.DataFrame(v, index=names, columns=names)
                       for v in (frame_testing.MASS, frame_testing.STIFFNESS))
    response = pandas.DataFrame(floors, columns=names)
    given = dict(ground=ground, step=frame_testing.STEP)
    found = pinode.identify(mass, stiffness, response[names[::-1]], **given)
    assert found.case.dofs == names and found.verdict == "good"
    assert found["k_ground_low"] == pytest.approx(-0.1, abs=2e-3)
    with pytest.raises(pinode.Error, match="response has the column 'top', which is no DOF of the "
                                           r"model \(low, middle, roof\), expected at="):
        pinode.identify(mass, stiffness, response.rename(columns={"roof": "top"}), **given)
