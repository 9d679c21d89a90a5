"""What a case is for, and where it stands: cases that are read, changed, saved and
pickled."""

import os
import pathlib
import pickle
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
