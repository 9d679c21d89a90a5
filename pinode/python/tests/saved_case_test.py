"""What a case is for, and where it stands: cases that are read, changed, saved and
pickled."""

import os
import pathlib
import pickle
import shutil
import subprocess

import conftest
import frame_testing
import numpy as np
import pytest

import pinode

DATA = pathlib.Path(os.environ["PINODE_SOURCE_DIR"]) / "data"
LOAD = 1e4 * np.sin(0.3 * np.arange(200.0))  # N


def load(channels=(), **keys):
    return pinode.Record("load", step=frame_testing.STEP, force={"u3": LOAD}, start="rest",
                         interpolation="linear", channels=channels, **keys)


def case(*channels, **tables):
    return pinode.Case(conftest.model(), groups=conftest.groups(), records=[load(channels)],
                       **tables)


PLAN = {"candidate": [{"quantity": "displacement", "sigma": 1e-4, "unit": "m"}]}
PLANNED = {
    "no channels": lambda: case(),
    "no channels, a plan": lambda: case(plan=PLAN),
    "channels without values, a plan": lambda: case(pinode.Channel("a", dof="u1"), plan=PLAN),
}


@pytest.mark.parametrize("name", PLANNED)
def test_planning_cases_come_back(name, tmp_path):
    made = PLANNED[name]()
    expected = made.plan_sensors(2).deviations
    made.save(tmp_path)
    path = tmp_path / "case.toml"
    tree = made.to_dict()
    ways = [pinode.read_case(path, planning=True), pinode.Case.from_dict(tree),
            pickle.loads(pickle.dumps(made)), made.replace(title="b")]
    ways += [way.replace(title="c") for way in ways]
    if "without values" not in name:
        ways += [pinode.read_case(path), pinode.Case.read(path)]
    for other in ways:
        assert other.plan_sensors(2).deviations == expected
        with pytest.raises(pinode.Error, match="for a plan and has no measured"):
            other.identify()
    program = pathlib.Path(os.environ["PINODE_BUILD_DIR"], "apps/pinode_check")
    if program.exists():
        subprocess.run([program, f"--case={path}", "--plan=2"], check=True, capture_output=True)


def test_cases_of_files_can_be_planned_with(tmp_path):
    read = pinode.read_case(DATA / "three_storey" / "three_storey.toml", planning=True)
    assert read.plan_sensors(2).names
    with pytest.raises(pinode.Error, match="planning is a value of type str"):
        pinode.read_case("a.toml", planning="yes")


def test_replacing_a_part_leaves_a_case_what_it_is_for():
    simulated = case(pinode.Channel("a", dof="u1"))
    expected = simulated.simulate()["load"]["channels"]["a"]
    for other in (pickle.loads(pickle.dumps(simulated)), pinode.Case.from_dict(simulated.to_dict())):
        again = other.replace(title="x")
        assert again.title == "x"
        assert np.array_equal(again.simulate()["load"]["channels"]["a"], expected)
        # With values it is for fits.
        noisy = expected + 0.01 * expected.std() * np.random.default_rng(1).standard_normal(len(expected))
        full = other.replace(records=[load([pinode.Channel("a", noisy, dof="u1")])])
        assert full.identify().usable
    # Of a file whose responses were not read.
    path = DATA / "three_storey" / "three_storey.toml"
    read = pinode.read_case(path, simulation=True).replace(title="y")
    assert read.title == "y" and read.simulate()
    with pytest.raises(pinode.Error, match="for a simulation"):
        read.identify()


def copied(tmp_path):
    shutil.copytree(DATA / "three_storey", tmp_path / "three_storey")
    return tmp_path / "three_storey" / "three_storey.toml"


def same(a, b):
    assert a.parameters == b.parameters and np.array_equal(a.stiffness, b.stiffness)
    for record in a.records:
        ours, theirs = a.measured(record), b.measured(record)
        assert all(np.array_equal(ours[k], theirs[k], equal_nan=True) for k in ours)


def test_cases_of_files_can_be_saved_elsewhere(tmp_path):
    path = copied(tmp_path)
    read = pinode.read_case(path)
    before = path.read_text()
    read.replace(title="b").save(tmp_path / "changed" / "deep")
    again = pinode.read_case(tmp_path / "changed" / "deep" / "case.toml")
    assert again.title == "b"
    same(read, again)
    read.save(tmp_path / "plain")
    same(read, pinode.read_case(tmp_path / "plain" / "case.toml"))
    # Data files stay where they are.
    assert sorted(p.name for p in (tmp_path / "plain").iterdir()) == ["case.toml"]
    assert "three_storey/" in (tmp_path / "plain" / "case.toml").read_text()
    # Arrays of new parts are written beside it.
    other = read.replace(groups=[pinode.Group("k1", np.eye(len(read.dofs)))])
    other.save(tmp_path / "arrays")
    same(other, pinode.read_case(tmp_path / "arrays" / "case.toml"))
    assert path.read_text() == before


def test_a_case_is_not_saved_over_itself(tmp_path):
    path = copied(tmp_path)
    path = path.rename(path.with_name("case.toml"))
    before = path.read_text()
    with pytest.raises(pinode.Error, match="would overwrite the case itself"):
        pinode.read_case(path).replace(title="b").save(path.parent)
    assert path.read_text() == before


def test_files_named_in_memory_are_found_from_where_a_case_is_saved(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.savetxt("a.csv", np.column_stack([LOAD, LOAD]), delimiter=",", header="F,a", comments="")
    made = pinode.Case(conftest.model(), groups=conftest.groups(), records=[pinode.Record(
        "load", file="a.csv", step=0.01, force={"u3": {"column": "F", "unit": "N"}},
        interpolation="linear", channels=[pinode.Channel("a", "a", dof="u1", unit="m/s^2")])])
    made.save("saved")
    same(made, pinode.read_case(tmp_path / "saved" / "case.toml"))
