"""Names of DOFs that frames and columns of pandas have, in another order than the model."""

import frame_testing
import numpy as np
import pytest

import pinode

pandas = pytest.importorskip("pandas")
MASS, STIFFNESS = np.diag([1.0, 2.0, 3.0]), 100.0 * np.array(
    [[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
ORDER = "has the columns .*in their order"
PLACE = "at place 0, but .*expected the same order"
DIFFERENT = "has rows and columns of different names"


def frame(matrix, columns, index=None):
    return pandas.DataFrame(matrix, columns=columns, index=columns if index is None else index)


def series(values, index):
    return pandas.Series(values, index=index)


@pytest.mark.parametrize("kind", [list, np.array, lambda v: np.array(v, dtype=np.int32)])
def test_whole_numbers_are_names(kind):
    names, turned = kind([1, 2, 3]), kind([3, 2, 1])
    assert pinode.Model(frame(MASS, names), frame(STIFFNESS, names))["dofs"] == ["1", "2", "3"]
    assert pinode.Model(frame(MASS, names), frame(STIFFNESS, ["1", "2", "3"]))["dofs"][0] == "1"
    with pytest.raises(pinode.Error, match="stiffness has columns of other names than mass"):
        pinode.Model(frame(MASS, names), frame(STIFFNESS, turned))
    with pytest.raises(pinode.Error, match=ORDER):
        pinode.Model(frame(MASS, turned), STIFFNESS, dofs=[1, 2, 3])
    model = pinode.Model(MASS, STIFFNESS, dofs=kind([1, 2, 3]))
    with pytest.raises(pinode.Error, match=ORDER):
        pinode.Case(model, groups=[pinode.Group("g", frame(STIFFNESS, turned))])
    assert pinode.Case(model, groups=[pinode.Group("g", frame(STIFFNESS, names))]).dofs[2] == "3"


@pytest.mark.parametrize("columns, index", [
    ([1, 2, 3], [3, 2, 1]), ([0, 1, 2], [2, 1, 0]), ([2, 1, 0], [0, 1, 2]), ([0, 1, 2], [1, 2, 3]),
    (["a", "b", "c"], ["c", "b", "a"]), (["a", "b", "c"], [1, 2, 3])])
def test_rows_are_as_columns(columns, index):
    with pytest.raises(pinode.Error, match="stiffness " + DIFFERENT):
        pinode.Model(MASS, frame(STIFFNESS, columns, index))
    with pytest.raises(pinode.Error, match="matrix " + DIFFERENT):
        pinode.Group("g", frame(STIFFNESS, columns, index))
    with pytest.raises(pinode.Error, match="mass " + DIFFERENT):
        pinode.FiniteElementModel(frame(MASS, columns, index), STIFFNESS)


@pytest.mark.parametrize("columns, index, dofs", [
    ([0, 1, 2], [0, 1, 2], ["u1", "u2", "u3"]), ([1, 2, 3], [0, 1, 2], ["1", "2", "3"]),
    (["a", "b", "c"], [0, 1, 2], ["a", "b", "c"]), ([0, 1, 2], ["a", "b", "c"], ["a", "b", "c"])])
def test_the_numbers_of_pandas_are_no_names(columns, index, dofs):
    assert pinode.Model(frame(MASS, columns, index), STIFFNESS)["dofs"] == dofs


@pytest.mark.parametrize("labels", [
    pandas.MultiIndex.from_product([["n"], ["x", "y", "z"]]), [1.0, 2.0, 3.0], [False, True, 2],
    pandas.date_range("2020-01-01", periods=3)])
def test_labels_that_are_no_names_are_refused(labels):
    with pytest.raises(pinode.Error, match=r"mass has the column .*mass.to_numpy\(\) has none"):
        pinode.Model(pandas.DataFrame(MASS, columns=labels), STIFFNESS)
    with pytest.raises(pinode.Error, match="response has the column .*or at="):
        pinode.identify(MASS, STIFFNESS, pandas.DataFrame(np.ones((9, 3)), columns=labels),
                        ground=np.ones(9), fs=100)
    with pytest.raises(pinode.Error, match="values has the column .*or dofs="):
        pinode.channels("y", pandas.DataFrame(np.ones((9, 3)), columns=labels), "displacement")


def test_groups_of_a_shear_building():
    part = frame(np.diag([0.0, 100.0]), ["u1", "u2"])
    turned = part.loc[["u2", "u1"], ["u2", "u1"]]
    for dofs in (None, ["u1", "u2"]):
        building = pinode.ShearBuilding([1.0, 1.0], [100.0, 100.0], dofs=dofs)
        assert pinode.Case(building, groups=[pinode.Group("g", part)]).dofs == ["u1", "u2"]
        with pytest.raises(pinode.Error, match=r"groups\[0\]: matrix " + ORDER):
            pinode.Case(building, groups=[pinode.Group("g", turned)])


def test_groups_of_a_model_that_is_replaced_or_renamed():
    names, part = ["a", "b", "c"], np.diag([1.0, 0.0, 0.0])
    turned = frame(part, names[::-1])
    model = pinode.Model(frame(MASS, names), STIFFNESS, dofs=["p", "q", "r"])
    with pytest.raises(pinode.Error, match=ORDER):
        pinode.Case(model, groups=[pinode.Group("g", turned)])
    with pytest.raises(pinode.Error, match=r"groups\[1\].*expected the order that groups\[0\] has"):
        pinode.Case(pinode.Model(MASS, STIFFNESS), groups=[
            pinode.Group("one", frame(part, names)), pinode.Group("two", turned)])
    read = pinode.Case.from_dict(pinode.Case(pinode.Model(MASS, STIFFNESS, dofs=names)).to_dict())
    with pytest.raises(pinode.Error, match=ORDER):
        read.replace(groups=[pinode.Group("g", turned)])
    assert read.replace(groups=[pinode.Group("g", frame(part, names))]).dofs == names


def test_groups_of_a_finite_element_model():
    names = ["a", "b", "c"]

    def case(matrix, key="matrix", **keys):
        model = pinode.FiniteElementModel(MASS, STIFFNESS, dofs=names, **keys)
        return pinode.Case(model, groups=[pinode.Group("g", **{key: matrix})])

    small, whole = np.diag([1.0, 0.0]), np.diag([1.0, 0.0, 0.0])
    assert case(frame(small, ["a", "b"]), remove_dofs=["c"]).dofs == ["a", "b"]
    assert case(frame(whole, names), remove_dofs=["c"]).dofs == ["a", "b"]
    guyan = {"reduction": {"method": "guyan", "keep": ["c", "a"]}}
    assert case(frame(small, ["c", "a"]), **guyan).dofs == ["c", "a"]
    assert case(frame(whole, names), **guyan).dofs == ["a", "c"]
    for matrix, keys in ((frame(small, ["b", "a"]), {"remove_dofs": ["c"]}),
                         (frame(whole, names[::-1]), {"remove_dofs": ["c"]}),
                         (frame(whole, names[::-1]), guyan), (frame(whole, names[::-1]), {})):
        with pytest.raises(pinode.Error, match=r"groups\[0\]: matrix " + ORDER):
            case(matrix, **keys)
    model = pinode.FiniteElementModel(MASS, STIFFNESS, dofs=names, **guyan)
    both = [pinode.Group("w", frame(whole, names)), pinode.Group("s", frame(small, ["c", "a"]))]
    assert pinode.Case(model, groups=both).dofs == ["c", "a"]
    with pytest.raises(pinode.Error, match="expected the DOFs of the model in their order: c, a"):
        case(frame(small, ["a", "c"]), **guyan)
    for key in ("changed_export", "set_export"):
        with pytest.raises(pinode.Error, match=f"{key} {ORDER}"):
            case(frame(whole, names[::-1]), key)


def test_frames_of_a_finite_element_model():
    names = ["a", "b", "c"]
    made = pinode.FiniteElementModel(frame(MASS, names), frame(STIFFNESS, names))
    assert pinode.Case(made).dofs == names
    with pytest.raises(pinode.Error, match="stiffness has columns of other names than mass"):
        pinode.FiniteElementModel(frame(MASS, names), frame(STIFFNESS, names[::-1]))
    with pytest.raises(pinode.Error, match=ORDER):
        pinode.FiniteElementModel(frame(MASS, names), STIFFNESS, dofs=names[::-1])


def test_columns_with_a_value_for_each_dof():
    names, values = ["u1", "u2"], [1.0, 2.0]
    turned = series(values, names[::-1])
    assert pinode.ShearBuilding(series(values, names), series(values, ["s1", "s2"]))
    # A table from the roof down, turned over.
    assert pinode.ShearBuilding(series(values, [1, 0]), series(values, [1, 0]))
    assert pinode.ShearBuilding(series(values, [3.2, 6.4]), values)  # heights
    for masses, stiffnesses, dofs in ((turned, values, None), (values, turned, names),
                                      (series(values, [2, 1]), values, [1, 2]),
                                      (series(values, [0, 1]), series(values, [1, 0]), None),
                                      (series(values, ["a", "b"]), series(values, ["b", "a"]), None)):
        with pytest.raises(pinode.Error, match="ShearBuilding: .*" + PLACE):
            pinode.ShearBuilding(masses, stiffnesses, dofs=dofs)
    for make in (lambda **k: pinode.Model(np.eye(2), np.eye(2), **k),
                 lambda **k: pinode.ShearBuilding(values, values, **k)):
        assert make(influence={"x": series(values, names)})
        with pytest.raises(pinode.Error, match=r"influence\['x'\] has 'u2' " + PLACE):
            make(influence={"x": turned})
    record = pinode.Record("r", step=0.01, start={"x": turned, "v": values},
                           channels=[pinode.Channel("a", np.arange(9.0) ** 2, dof="u1")])
    with pytest.raises(pinode.Error, match=r"record 'r': start\['x'\] has 'u2' " + PLACE):
        pinode.Case(pinode.ShearBuilding(values, values, damping="none"), records=[record],
                    groups=[pinode.Group("k", storey=1)])


def test_shapes_of_modes():
    shape = series([1.0, 2.0], ["u2", "u1"])
    assert pinode.Mode(1.0, shape=shape)["shape"] == {"u2": 1.0, "u1": 2.0}
    assert pinode.Mode(1.0, shape=shape, dofs=["u2", "u1"])["shape"] == {"u2": 1.0, "u1": 2.0}
    with pytest.raises(pinode.Error, match="Mode: shape has 'u2' " + PLACE):
        pinode.Mode(1.0, shape=shape, dofs=["u1", "u2"])
    with pytest.raises(pinode.Error, match="shape is an array of 2 x 1, expected one value"):
        pinode.Mode(1.0, shape=shape.to_frame(), dofs=["u2", "u1"])


@pytest.mark.parametrize("index", [
    0.01 * np.arange(60), pandas.date_range("2020-01-01", periods=60, freq="10ms"),
    pandas.date_range("2020-01-01", periods=60, freq="10ms", tz="Europe/Vienna"),
    pandas.timedelta_range("0s", periods=60, freq="10ms"), [f"s{i:02}" for i in range(60)],
    np.arange(100, 160)])
def test_rows_are_the_same_samples(index):
    wave = np.sin(np.arange(60.0) ** 1.5)
    whole = pandas.Series(wave, index=index)
    table = pandas.DataFrame({"a": wave, "b": wave}, index=index)

    def record(one, two, **keys):
        return pinode.Record("r", **{"step": 0.01, **keys}, ground={"x": one},
                             interpolation="linear", channels=[
                                 pinode.Channel("a", two, dof="u1"), pinode.Channel("b", wave)])

    assert record(whole, whole) and record(whole, wave) and record(whole, pandas.Series(wave))
    assert record(whole, "a", file=table)
    late, early, turned = whole.iloc[10:], whole.iloc[:-10], whole.iloc[::-1]
    for one, two in ((turned, whole), (whole, turned)):
        with pytest.raises(pinode.Error, match=r"record 'r': ground\['x'\] has an index that "
                                               "differs from that of channel 'a'"):
            record(one, two)
    with pytest.raises(pinode.Error, match=r"ground\['x'\] has an index that .* that of file"):
        record(turned, "a", file=table)
    with pytest.raises(pinode.Error, match="identify: ground has an index that .* of response"):
        pinode.identify(MASS, STIFFNESS, pandas.DataFrame({k: late for k in ("u1", "u2", "u3")}),
                        ground=early, fs=100)
    with pytest.raises(pinode.Error, match="loads has an index that .* of records"):
        pinode.identify_modes(table, loads=turned, fs=100)
    with pytest.raises(pinode.Error, match="responses has an index that .* of force"):
        pinode.estimate_frfs(turned, table, fs=100)


def test_clocks_within_half_a_sample_are_the_same():
    wave = np.sin(np.arange(60.0) ** 1.5)
    for shift, is_same in ((4e-3, True), (1e-2, False)):
        one, two = (pandas.Series(wave, index=0.01 * np.arange(60) + s) for s in (0.5, 0.5 + shift))

        def record():
            return pinode.Record("r", step=0.01, ground={"x": one}, interpolation="linear",
                                 channels=[pinode.Channel("a", two, dof="u1")])

        if is_same:
            assert record()
        else:
            with pytest.raises(pinode.Error, match="differs from that of channel 'a'"):
                record()


def test_channels_of_a_frame():
    values = np.arange(30.0).reshape(10, 3)

    def dofs(columns, **keys):
        made = pinode.channels("y", pandas.DataFrame(values, columns=columns), "velocity", **keys)
        assert np.array_equal(made[0]["values"], values[:, 0])
        return [channel["dof"] for channel in made]

    assert dofs([0, 1, 2]) == dofs(["a", "b", "c"]) == ["u1", "u2", "u3"]
    assert dofs(["u3", "u1", "u12"]) == ["u3", "u1", "u12"]
    assert dofs([3, 2, 1], dofs=[3, 2, 1]) == ["3", "2", "1"]
    with pytest.raises(pinode.Error, match="expected dofs="):
        dofs([3, 2, 1])
    with pytest.raises(pinode.Error, match="expected dofs="):
        dofs(["u1", "note", "u2"])
    with pytest.raises(pinode.Error, match="values has 'b' " + PLACE):
        dofs(["b", "a", "c"], dofs=["a", "b", "c"])


def test_responses_of_one_call():
    ground, floors = frame_testing.measure((0.1, 0.0, 0.0), samples=600)
    model = (frame_testing.MASS, frame_testing.STIFFNESS)
    given = dict(ground=ground, step=frame_testing.STEP, damping=frame_testing.DAMPING)

    def dofs(columns, values=floors, **keys):
        found = pinode.identify(*model, pandas.DataFrame(values, columns=columns), **given, **keys)
        assert found["k_ground_" + found.case.dofs[0]] == pytest.approx(-0.1, abs=0.02)
        return [channel["dof"] for channel in found.case.to_dict()["record"][0]["channel"]]

    assert dofs(np.array([3, 2, 1]), floors[:, ::-1], dofs=[1, 2, 3]) == ["3", "2", "1"]
    assert dofs([0, 1, 2], dofs=[1, 2, 3]) == ["1", "2", "3"]
    for columns, keys, message in (
            ([3, 2, 1], {}, "response has the column '3', which is no DOF"),
            ([1, 2, 4], {"dofs": [1, 2, 3]}, "response has the column '4', which is no DOF"),
            ([0, 1, 2], {"dofs": [2, 1, 0]}, "response has '0' " + PLACE),
            (["U1", "U3", "U2"], {}, "column 'U1'.*did you mean 'u1'"),
            ([" u1", "u2 ", "x"], {}, "column '.*is no DOF"),
            (["u3", "u2", "u1"], {"at": ["u1", "u2", "u3"]}, r"'u3' at place 0, but at\[0\]")):
        with pytest.raises(pinode.Error, match=message):
            dofs(columns, **keys)


def test_places_of_modes_and_of_frequency_responses():
    _, floors = frame_testing.measure(samples=600)
    names = ["a", "b", "c"]
    table = pandas.DataFrame(floors, columns=names)
    with pytest.raises(pinode.Error, match="records has 'a' " + PLACE):
        pinode.identify_modes(table, names=names[::-1], fs=100)
    force = floors[:, 0]
    found = pinode.estimate_frfs(force, table, fs=100, excitation="random", block=1.0)
    assert found.responses == names and found.references == ["f1"]
    with pytest.raises(pinode.Error, match="responses has 'a' " + PLACE):
        pinode.estimate_frfs(force, table, names=np.array(names[::-1]), fs=100)
    with pytest.raises(pinode.Error, match=r"responses\[1\] has the columns c, b, a, expected"):
        pinode.estimate_frfs([force, force], [table, table[names[::-1]]], fs=100)
