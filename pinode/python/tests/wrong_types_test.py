"""A value of a type that an argument cannot be is a pinode.Error that names it."""

import json
import os
import shutil

import numpy as np
import pytest
import scipy.sparse

import pinode
from pinode import calculix, elements, figures, frames, opensees

MODEL = pinode.ShearBuilding([1.0, 1.0], [100.0, 100.0], damping={"ratios": [0.02, 0.02]})


def record(**keys):
    values = np.sin(0.1 * np.arange(200.0))
    channels = [pinode.Channel("a", values, "absolute_acceleration", dof="u1")]
    return pinode.Record("r", channels=channels, step=0.01, ground={"x": values},
                         interpolation="linear", **keys)


def fitted():
    return pinode.Case(MODEL, records=[record()], groups=[pinode.Group("k1", storey=1)])


def shaken():
    return pinode.Case(MODEL, records=[pinode.Record(
        "r", step=0.01, ground={"x": np.ones(50)}, interpolation="linear", start="rest",
        channels=[pinode.Channel("a", dof="u1")])])


@pytest.mark.parametrize("call, message", [
    (lambda: pinode.ShearBuilding([1.0, 1.0, 1.0], [100.0, 100.0]),
     "stiffnesses has 2 values, expected 3, one for each of masses"),
    (lambda: pinode.ShearBuilding([1.0, 1.0], [100.0, 100.0], dampers=[1.0]),
     "dampers has 1 value, expected 2"),
    (lambda: pinode.ShearBuilding([1.0, -1.0], [100.0, 100.0]),
     r"masses\[1\] is -1.0, expected a positive number"),
    (lambda: pinode.ShearBuilding([1.0, 1.0], np.array([100.0, np.nan])),
     r"stiffnesses\[1\] is nan, expected a positive number"),
    (lambda: pinode.ShearBuilding(["heavy", 1.0], [100.0, 100.0]), r"masses\[0\] is heavy"),
    (lambda: pinode.Model(np.eye(2), np.array([[1.0, np.nan], [np.nan, 1.0]])),
     "stiffness has a value that is not finite"),
    (lambda: pinode.Model(np.eye(2), scipy.sparse.csc_matrix([[1.0, 0.0], [0.0, np.inf]])),
     "stiffness has a value that is not finite"),
])
def test_values_are_refused_by_the_constructor(call, message):
    with pytest.raises(pinode.Error, match=message):
        call()


@pytest.mark.parametrize("name", figures.__all__)
def test_figures(name):
    for value in (None, 3, {}):
        with pytest.raises(pinode.Error, match="expected a result"):
            getattr(figures, name)(value)


@pytest.mark.parametrize("call, named", [
    (lambda: frames.frame(None, "parameters"), "frame of a NoneType"),
    (lambda: frames.of_modes(3), "frame of a int"),
    (lambda: frames.of_plan(3), "frame of a int"),
    (lambda: frames.of_simulation(3), "frame of a int"),
    (lambda: pinode.read_case(3), "path"),
    (lambda: pinode.read_result(3), "path"),
    (lambda: pinode.Case.from_dict(3), "tree"),
    (lambda: pinode.Record("r", channels=3, step=0.01), "channels"),
    (lambda: pinode.Element("e", "linear", ["ground", "u1"], 3), "parameters"),
    (lambda: pinode.Element("e", "linear", 3), "between"),
    (lambda: pinode.Element("e", "own", ["ground", "u1"], file=3), "file"),
    (lambda: pinode.Library("l", ["x[u1]"], "u1", None), "terms"),
    (lambda: pinode.Library("l", 3, "u1", ["x[u1]"]), "inputs"),
    (lambda: pinode.Network("n", ["x[u1]"], 3), "outputs"),
    (lambda: pinode.Group("k1", between=3), "between"),
    (lambda: pinode.Model(np.eye(1), np.eye(1), dofs=3), "dofs"),
    (lambda: pinode.identify_modes(np.zeros((100, 2)), step=0.01, names=3), "names"),
    (lambda: pinode.identify_modes(np.zeros((100, 2)), step=0.01, quantity=3), "quantity"),
    (lambda: calculix.export(3, ["columns"]), "deck"),
    (lambda: calculix.export("frame.inp", 3), "sets"),
    (lambda: elements.build("struct A {};", 3), "library"),
    (lambda: elements.build("struct A {};", "a.so", include=3), "include"),
    (lambda: pinode.Case(MODEL).save(3), "folder"),
    (lambda: pinode.Case(MODEL, records=[record()], groups=[
        pinode.Group("k1", storey=1)]).damage(3), "baselines"),
    (lambda: pinode.Case(MODEL).replace(records=3), "record"),
    (lambda: pinode.Case(MODEL, records=record()), r"records is a single Record, expected a list"),
    (lambda: pinode.Case(MODEL).replace(groups={"name": "k"}), "groups is a single dict"),
    (lambda: pinode.Model(np.eye(2), np.eye(2), dofs="ab"), "dofs is the text 'ab', expected a list"),
    (lambda: pinode.Group("k", between="u1"), "between is the text 'u1', expected a list"),
    (lambda: pinode.Model([1.0, 1.0], np.eye(2)), "mass is an array of 2 numbers, expected n x n"),
    (lambda: pinode.Model([[1.0, 1.0], [2.0]], np.eye(2)), "mass is no array, expected n x n"),
    (lambda: pinode.identify_modes([[1, 2], [3]], step=0.1), "not an array"),
    (lambda: pinode.identify_modes(np.zeros((9, 1)), step=0.1, quantity=[[1]]), "quantity"),
    (lambda: pinode.channels("a", np.zeros((4, 1)), "strain", dofs=3), "dofs"),
    (lambda: pinode.channels("a", [[1.0, 2.0], [3.0]], "strain"), "not an array"),
    (lambda: pinode.Channel("a", quantity="acceleration"), "absolute_acceleration"),
    (lambda: pinode.Mode(1.0, shape=3, dofs=["u1"]), "shape"),
    (lambda: pinode.Mode(1.0, shape=[1.0], dofs=3), "dofs"),
    (lambda: shaken().simulate().to_pandas([]), "no record"),
    (lambda: fitted().identify(callback=3), "callback"),
    (lambda: fitted().identify(progress=np.zeros(2)), "progress"),
    (lambda: fitted().identify(output="x", mat=np.zeros(2)), "mat"),
    (lambda: fitted().identify(mat=np.zeros(2)), "mat"),
    (lambda: fitted().discover(callback="x"), "callback"),
    (lambda: fitted().check(output="a\0b"), "output is 'a.*expected a path"),
    (lambda: fitted().save("\ud800"), "folder is .*expected a path"),
    (lambda: pinode.read_case("a.toml", simulation=np.zeros(2)), "simulation"),
    (lambda: pinode.read_case("\0"), "path"),
    (lambda: pinode.read_result("x" * 5000), "cannot be read"),
    (lambda: opensees.read_matrix(1), "path"),
    (lambda: opensees.read_matrix(True), "path"),
    (lambda: opensees.read(3, 4, dofs={1: [0]}), "path"),
    (lambda: opensees.condense(np.eye(1), np.eye(1), dofs={1: [0]}).condense("x"), "group's matrix"),
    (lambda: calculix.element_sets(3), "deck"),
    (lambda: calculix.export("a.inp", ["a"], factor="2"), "factor"),
    (lambda: calculix.export("a.inp", ["a"], factor=10**400), "factor"),
    (lambda: calculix.export("a.inp", ["a"], masses=None), "masses"),
    (lambda: calculix.export("a.inp", [3]), "a set"),
    (lambda: calculix.export("a.inp", ["a"], ccx=None), "ccx"),
    (lambda: calculix.export("a\0.inp", ["a"]), "deck"),
    (lambda: elements.build("struct A {};", "a.so", compiler=None), "compiler"),
    (lambda: pinode.watch.Store(5), "path"),
    (lambda: pinode.watch.Store("x" * 5000), "no such store"),
    (lambda: pinode.watch.Store("a.db", 5), "structure"),
    (lambda: elements.build("\0", "a.so", compiler="true"), "source"),
])
def test_is_named(call, named):
    with pytest.raises(pinode.Error, match=named) as failure:
        call()
    assert "\n" not in str(failure.value)


def test_numbers_are_no_files(capfd):
    """To Python they are those that are open: standard output was closed."""
    with pytest.raises(pinode.Error, match="path"):
        opensees.read_matrix(1)
    os.write(1, b"still there")
    assert capfd.readouterr().out == "still there"


def test_folders_that_cannot_be_made(tmp_path):
    if shutil.which("ccx") is None:
        pytest.skip("CalculiX is not installed")
    (tmp_path / "a.inp").write_text(
        "*NODE\n1,0,0,0\n*ELEMENT,TYPE=SPRINGA,ELSET=s\n1,1,1\n*SPRING,ELSET=s\n\n1.0\n")
    for keys in ({"folder": "/proc/x"}, {"folder": 3}):
        with pytest.raises(pinode.Error, match="/proc/x: cannot be written|folder is a value"):
            calculix.export(tmp_path / "a.inp", ["s"], **keys)


def test_groups_of_sparse_matrices():
    condensed = opensees.condense(np.eye(2), 2.0 * np.eye(2), dofs={1: [0, 1]})
    part = scipy.sparse.csc_matrix(np.diag([1.0, 0.0]))
    assert np.array_equal(condensed.condense(part), part.toarray())


def test_results_of_nothing(tmp_path):
    (tmp_path / "result.json").write_text(json.dumps({"schema": "pinode-result-1"}))
    result = pinode.read_result(tmp_path)
    for name in ("usable", "message", "parameters", "records", "modes"):
        with pytest.raises(pinode.Error, match=f"has no '{name}'"):
            getattr(result, name)


def test_arrays_in_any_order():
    values = np.sin(0.1 * np.arange(400.0)).reshape(2, 200) + np.arange(200.0)
    packed = np.zeros(200, dtype=[("flag", "u1"), ("a", "f8")])
    packed["a"] = values[1]
    plain = np.ascontiguousarray(values[1])
    strided = np.asfortranarray(values)[1]
    backwards = plain[::-1].copy()[::-1]
    assert strided.strides == (16,) and backwards.strides[0] < 0
    for column in (plain, strided, backwards, packed["a"], plain.astype(">f8")):
        case = pinode.Case(MODEL, groups=[pinode.Group("k1", storey=1)], records=[
            pinode.Record("r", channels=[pinode.Channel("a", column, dof="u1")], step=0.01,
                          ground={"x": column}, interpolation="linear")])
        assert np.array_equal(case.measured("r")["a"], plain)
    stiffness = np.arange(1.0, 10.0).reshape(3, 3) + 20.0 * np.eye(3)
    stiffness = stiffness + stiffness.T
    for matrix in (stiffness, np.asfortranarray(stiffness), stiffness[::-1, ::-1].copy()[::-1, ::-1],
                   np.kron(stiffness, np.ones((2, 2)))[::2, ::2]):
        case = pinode.Case(pinode.Model(np.eye(3), matrix, {"ratios": [0.02]}))
        assert np.array_equal(case.stiffness, stiffness)


def test_folders_that_are_there_speak_of_arguments(tmp_path):
    (tmp_path / "note.txt").write_text("mine")
    for work in (lambda: fitted().identify(output=tmp_path), lambda: fitted().check(output=tmp_path),
                 lambda: shaken().simulate().save(tmp_path)):
        with pytest.raises(pinode.Error, match="give a new one, overwrite=True, or") as failure:
            work()
        assert "--" not in str(failure.value)
