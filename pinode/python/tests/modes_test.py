"""Modes of records alone."""

import json
import os
import pickle
import subprocess
from pathlib import Path

import frame_testing
import numpy as np
import pytest
import scipy.linalg

import pinode

STEP = 0.02
CASE = Path(os.environ["PINODE_SOURCE_DIR"], "data/three_storey_ambient",
            "three_storey_ambient.toml")


def accelerations(loads, start=0.0):
    """Of the frame under loads (samples x 3) held between samples; start: all
    displacements at first."""
    inverse = np.linalg.inv(frame_testing.MASS)
    damping = 8e-4 * frame_testing.STIFFNESS
    a = np.block([[np.zeros((3, 3)), np.eye(3)],
                  [-inverse @ frame_testing.STIFFNESS, -inverse @ damping]])
    power = scipy.linalg.expm(STEP * a)
    gain = np.linalg.solve(a, power - np.eye(6))[:, 3:] @ inverse
    state, rows = np.repeat([start, 0.0], 3), np.empty(loads.shape)
    for i, load in enumerate(loads):
        rows[i] = a[3:] @ state + inverse @ load
        state = power @ state + gain @ load
    return rows


def truth():
    values, _ = scipy.linalg.eigh(frame_testing.STIFFNESS, frame_testing.MASS)
    return np.sqrt(values) / (2 * np.pi)


@pytest.fixture(scope="module")
def loads():
    return 1e3 * np.random.default_rng(4).standard_normal((20000, 3))


@pytest.fixture(scope="module")
def rows(loads):
    return accelerations(loads)


def assert_found(modes):
    assert len(modes) == 3
    for mode, hz in zip(modes, truth()):
        assert abs(mode["frequency_hz"] - hz) < 4 * mode["frequency_sigma"] + 1e-3 * hz


def test_of_wind(rows):
    modes = pinode.identify_modes(rows, step=STEP, names=["u1", "u2", "u3"])
    assert_found(modes)
    assert modes.methods == {"record": "covariance_driven"}
    assert modes.places == ["u1", "u2", "u3"] and modes.shapes.shape == (3, 3)
    for band in modes.diagram:
        assert len(band["order"]) == len(band["frequency_hz"]) == len(band["mode"])
    assert set(modes.figures()) == {"stabilisation_record", "spectra_record", "shapes"}
    frame = modes.to_pandas()
    assert list(frame["frequency_hz"]) == list(modes.frequencies_hz)
    assert np.allclose(frame["u2"], modes.shapes[1].real)
    assert "damping ratio" in modes._repr_html_()
    other = pickle.loads(pickle.dumps(modes))
    assert np.array_equal(other.shapes, modes.shapes)
    assert set(other.figures()) == set(modes.figures())
    assert other.for_case()[0]["frequency"] == modes.for_case()[0]["frequency"]
    with pytest.raises(pinode.Error, match="from a pickle"):
        other.save("nowhere")
    with pytest.raises(pinode.Error, match="expected a geometry"):
        modes.structure()


def test_of_measured_loads(rows, loads):
    by_loads = pinode.identify_modes(rows, step=STEP, loads=loads)
    assert_found(by_loads)
    assert by_loads.methods == {"record": "input_output"}
    # What is known of the loads is no scatter.
    wind = pinode.identify_modes(rows, step=STEP)
    for known, unknown in zip(by_loads, wind):
        assert known["frequency_sigma"] < 0.5 * unknown["frequency_sigma"]
    same = pinode.identify_modes(rows, step=STEP, loads=loads, method="covariance_driven")
    assert np.array_equal(same.frequencies_hz, wind.frequencies_hz)


def test_of_a_decay():
    random = np.random.default_rng(5)
    decay = accelerations(np.zeros((1500, 3)), start=0.01)
    decay += 1e-3 * decay.std() * random.standard_normal(decay.shape)
    modes = pinode.identify_modes(
        {"decay": {"values": decay, "step": STEP, "free_decay": True}})
    assert_found(modes)
    assert modes.methods == {"decay": "ring_down"}


def test_of_a_case_as_the_program_finds_them(tmp_path):
    modes = pinode.identify_modes(CASE, output=tmp_path / "ours")
    program = Path(os.environ["PINODE_BUILD_DIR"], "apps/pinode_modes")
    if not program.exists():
        pytest.skip("pinode_modes is not built")
    subprocess.run([program, f"--case={CASE}", f"--output_dir={tmp_path}/theirs"],
                   check=True, capture_output=True)
    ours, theirs = (json.loads((tmp_path / name / "modes.json").read_text())
                    for name in ("ours", "theirs"))
    assert ours == theirs
    for name in ("modes.csv", "modes.toml", "modes.uff"):
        assert (tmp_path / "ours" / name).read_bytes() == (
            tmp_path / "theirs" / name).read_bytes()
    assert (tmp_path / "ours/report.html").stat().st_size > 1e4
    assert [m["frequency_hz"] for m in ours["modes"]] == pytest.approx(modes.frequencies_hz)
    with pytest.raises(pinode.Error, match="exists"):
        modes.save(tmp_path / "ours")
    # Before anything is identified.
    with pytest.raises(pinode.Error, match="exists"):
        pinode.identify_modes(np.zeros((4, 1)), step=-1.0, output=tmp_path / "ours")
    with pytest.raises(pinode.Error, match="expected no free_decay"):
        pinode.identify_modes(CASE, free_decay=True)
    with pytest.raises(pinode.Error, match="expected no loads"):
        pinode.identify_modes(CASE, loads=np.zeros((4, 1)))
    modes.save(tmp_path / "ours", overwrite=True)


def test_of_a_case_with_other_options():
    picked = pinode.identify_modes(CASE, pick=[5.0], max_order=20)
    whole = pinode.identify_modes(pinode.read_case(CASE))
    assert len(whole) == 3
    nearest = whole.frequencies_hz[np.argmin(abs(whole.frequencies_hz - 5.0))]
    assert len(picked) <= 1
    for hz in picked.frequencies_hz:
        assert hz == pytest.approx(nearest, rel=0.02)
    assert max(max(band["order"]) for band in picked.diagram) == 20


def test_of_tables_in_memory(rows):
    channels = [{"column": f"a{i}", "dof": f"u{i}", "quantity": "absolute_acceleration",
                 "unit": "m/s^2"} for i in (1, 2, 3)]
    table = {f"a{i}": rows[:, i - 1] for i in (1, 2, 3)}
    modes = pinode.identify_modes(
        {"record": [{"name": "wind", "file": table, "sampling_rate_hz": 1 / STEP,
                     "channel": channels}]})
    assert modes.methods == {"wind": "covariance_driven"}
    arrays = pinode.identify_modes(rows, step=STEP)
    assert np.allclose(modes.frequencies_hz, arrays.frequencies_hz, rtol=1e-9)


def test_are_the_measured_modes_of_a_case(rows):
    found = pinode.identify_modes(rows, step=STEP, names=["u1", "u2", "u3"])
    case = pinode.Case(
        pinode.Model(mass=frame_testing.MASS, stiffness=0.9 * frame_testing.STIFFNESS,
                     dofs=["u1", "u2", "u3"]),
        groups=[pinode.Group("all", matrix=0.9 * frame_testing.STIFFNESS)],
        modes=found.for_case())
    fit = case.identify()
    assert fit.usable
    assert abs(fit["all"] - 1 / 9) < 5 * fit.parameters["all"].sigma


def test_what_is_wrong_is_said(rows):
    with pytest.raises(pinode.Error, match="'step' is missing"):
        pinode.identify_modes(rows)
    with pytest.raises(pinode.Error, match="too short"):
        pinode.identify_modes(rows[:10], step=STEP)
    with pytest.raises(pinode.Error, match=r"\[modes\] max_order: record 'record'.*200"):
        pinode.identify_modes(rows, step=STEP, max_order=200)
    with pytest.raises(pinode.Error, match="method"):
        pinode.identify_modes(rows, step=STEP, method="magic")
    with pytest.raises(pinode.Error, match="no measured load"):
        pinode.identify_modes(rows, step=STEP, method="input_output")
    with pytest.raises(pinode.Error, match="references is a value of type str"):
        pinode.identify_modes(rows, step=STEP, references="a1")
    with pytest.raises(pinode.Error, match="loads"):
        pinode.identify_modes(rows, step=STEP, loads=[1.0, 2.0])
    with pytest.raises(pinode.Error, match="free_decay"):
        pinode.identify_modes(rows, step=STEP, free_decay="yes")
    with pytest.raises(pinode.Error, match="nowhere.toml"):
        pinode.identify_modes("nowhere.toml")
