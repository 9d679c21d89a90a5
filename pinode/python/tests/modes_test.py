"""Modes of records alone."""

import json
import os
import re
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
    assert set(modes.figures()) == {"stabilisation_record", "spectra_record", "fdd_record",
                                    "shapes", "mac"}
    frame = modes.to_pandas()
    assert list(frame["frequency_hz"]) == list(modes.frequencies_hz)
    assert np.allclose(frame["u2"], modes.shapes[1].real)
    assert "damping (%)" in modes._repr_html_()
    other = pickle.loads(pickle.dumps(modes))
    assert np.array_equal(other.shapes, modes.shapes)
    assert set(other.figures()) == set(modes.figures())
    assert other.for_case()[0]["frequency"] == modes.for_case()[0]["frequency"]
    with pytest.raises(pinode.Error, match="from a pickle"):
        other.save("nowhere")
    with pytest.raises(pinode.Error, match="has no geometry"):
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


@pytest.fixture(scope="module")
def sheet(rows, tmp_path_factory):
    """Data files of a thousand seconds of wind: without a time, and with one."""
    folder = tmp_path_factory.mktemp("sheet")
    np.savetxt(folder / "wind.csv", rows, delimiter=",", header="a1,a2,a3", comments="")
    timed = np.column_stack([STEP * np.arange(len(rows)), rows])
    np.savetxt(folder / "timed.csv", timed, delimiter=",", header="time,a1,a2,a3", comments="")
    np.savez(folder / "wind.npz", a1=rows[:, 0], a2=rows[:, 1], a3=rows[:, 2])
    return folder


def test_of_a_data_file(rows, sheet):
    arrays = pinode.identify_modes(rows, step=STEP)
    for path, given in ((sheet / "wind.csv", {"step": STEP}), (str(sheet / "timed.csv"), {}),
                        (sheet / "timed.csv", {"time": "time"}),
                        (sheet / "wind.npz", {"step": STEP, "columns": ["a1", "a2", "a3"]})):
        modes = pinode.identify_modes(path, **given)
        assert modes.places == ["a1", "a2", "a3"]
        assert modes.frequencies_hz == pytest.approx(arrays.frequencies_hz, rel=1e-6)
    some = pinode.identify_modes(sheet / "wind.csv", step=STEP, columns=["a1", "a3"],
                                 max_order=12)
    assert some.places == ["a1", "a3"]
    assert max(max(band["order"]) for band in some.diagram) == 12
    one = pinode.identify_modes(sheet / "wind.csv", step=STEP, columns="a2")
    assert one.places == ["a2"]
    # Of velocities shapes are others, frequencies are not.
    mixed = pinode.identify_modes(sheet / "wind.csv", step=STEP,
                                  quantity=["acceleration", "acceleration", "velocity"])
    assert not np.allclose(mixed.shapes, arrays.shapes, atol=0.1)


def test_of_text_of_an_unusual_form(rows, tmp_path):
    arrays = pinode.identify_modes(rows, step=STEP)
    lines = ["Messung|||", "Größe|a1|a2|a3"]
    lines += ["|".join([f"{12 + i // 180000}h{i // 3000 % 60}m{i % 3000 * STEP:.2f}",
                        *(f"{value:.9g}" for value in row)]).replace(".", ",")
              for i, row in enumerate(rows)]
    path = tmp_path / "form.csv"
    path.write_bytes("\n".join(lines).encode("UTF-16-LE"))
    form = dict(columns=["a1", "a2", "a3"], time="Größe", encoding="UTF-16LE", header_lines=2,
                delimiter="|", decimal=",", time_format="%Hh%Mm%S,%f")
    found = pinode.identify_modes(path, **form)
    assert found.frequencies_hz == pytest.approx(arrays.frequencies_hz, rel=1e-4)
    with pytest.raises(pinode.Error, match="time_format"):
        pinode.identify_modes(path, **{**form, "time_format": None})
    for given, sentence in (
            ({"header_lines": -3}, "header_lines: '-3', expected a number of lines"),
            ({"delimiter": "x"}, "delimiter: 'x', expected one of"),
            ({"decimal": "|"}, "decimal: '|', expected"),
            ({"decimal": ",", "delimiter": ","}, "delimiter: it is the sign of `decimal` too"),
            ({"encoding": "no such"}, "encoding 'no such' is not known"),
            ({"time_unit": "parsec"}, "time_unit: unit 'parsec' is not known"),
            ({"encoding": 3}, "encoding is the number 3, expected a text")):
        with pytest.raises(pinode.Error, match=re.escape(sentence)):
            pinode.identify_modes(path, **{**form, **given})
    with pytest.raises(pinode.Error, match="expected no encoding"):
        pinode.identify_modes(rows, step=STEP, encoding="UTF-8")
    with pytest.raises(pinode.Error, match="expected no decimal"):
        pinode.identify_modes(pinode.read_case(CASE), decimal=",")


def test_scales_of_a_data_file(rows, sheet):
    scaled = rows * np.array([1.0, 2.0, 0.5])
    arrays = pinode.identify_modes(scaled, step=STEP)
    plain = pinode.identify_modes(rows, step=STEP)
    wind = sheet / "wind.csv"
    each = pinode.identify_modes(wind, step=STEP, scale={"a2": 2, "a3": 0.5})
    assert np.allclose(each.shapes, arrays.shapes, atol=1e-6)
    assert not np.allclose(each.shapes, plain.shapes, atol=0.05)
    same = pinode.identify_modes(wind, step=STEP, scale=-3.0)
    assert np.allclose(same.shapes, plain.shapes, atol=1e-6)
    for scale, sentence in (({"a9": 2.0}, "scale: no channel 'a9'"),
                            ({"a1": 0.0}, "scale: a factor is 0 or not finite"),
                            (float("nan"), "scale: a factor is 0 or not finite"),
                            ({"a1": "2"}, "scale['a1'] is the text '2', expected a number"),
                            ("2", "scale is the text '2', expected a number or a dictionary")):
        with pytest.raises(pinode.Error, match=re.escape(sentence)):
            pinode.identify_modes(wind, step=STEP, scale=scale)
    with pytest.raises(pinode.Error, match="expected no scale"):
        pinode.identify_modes(rows, step=STEP, scale=2.0)


def test_quantities_as_channels_have_them(rows, sheet):
    keys = dict(step=STEP, block_rows=8, max_order=12)
    for longer, short in (("absolute_acceleration", "acceleration"),
                          ("relative_acceleration", "acceleration"),
                          ("absolute_displacement", "displacement")):
        for records in (rows, sheet / "wind.csv"):
            ours, theirs = (pinode.identify_modes(records, quantity=quantity, **keys)
                            for quantity in ([longer] * 3, short))
            assert np.array_equal(ours.shapes, theirs.shapes)
    with pytest.raises(pinode.Error, match="quantity is the text 'speed', expected one of displacement"):
        pinode.identify_modes(rows, quantity="speed", **keys)


def test_of_a_decay_in_a_file(tmp_path):
    decay = accelerations(np.zeros((1500, 3)), start=0.01)
    decay += 1e-3 * decay.std() * np.random.default_rng(5).standard_normal(decay.shape)
    np.savetxt(tmp_path / "decay.csv", decay, delimiter=",", header="a1,a2,a3", comments="")
    modes = pinode.identify_modes(tmp_path / "decay.csv", step=STEP, free_decay=True)
    arrays = pinode.identify_modes(decay, step=STEP, free_decay=True)
    assert set(modes.methods.values()) == {"ring_down"}
    assert modes.frequencies_hz == pytest.approx(arrays.frequencies_hz, rel=1e-6)


def test_of_a_data_file_as_the_program_finds_them(sheet, tmp_path):
    program = Path(os.environ["PINODE_BUILD_DIR"], "apps/pinode_modes")
    if not program.exists():
        pytest.skip("pinode_modes is not built")
    path = sheet / "wind.csv"
    pinode.identify_modes(path, step=STEP, columns=["a1", "a2"],
                          quantity=["acceleration", "velocity"], output=tmp_path / "ours")
    subprocess.run([program, f"--case={path}", "--columns=a1,a2",
                    "--quantities=acceleration,velocity", "--sampling_rate_hz=50",
                    f"--output_dir={tmp_path}/theirs"], check=True, capture_output=True)
    for name in ("modes.json", "modes.csv", "modes.toml", "modes.uff"):
        assert (tmp_path / "ours" / name).read_bytes() == (
            tmp_path / "theirs" / name).read_bytes()


def test_what_is_wrong_with_a_data_file_is_said(rows, sheet):
    wind = sheet / "wind.csv"
    for given, sentence in (
            ({}, "no column is recognised as the time"),
            ({"step": STEP, "columns": ["a9"]}, "a9"),
            ({"step": STEP, "columns": 3}, "columns is a value of type int"),
            ({"step": -1.0}, "'step' is the number -1.0"),
            ({"step": STEP, "time": "a1"}, "expected one of them"),
            ({"step": STEP, "time": 3}, "time is the number 3, expected the name of the column"),
            ({"step": STEP, "quantity": "force"}, "quantity 'force'"),
            ({"step": STEP, "quantity": ["velocity"] * 2}, "2 quantities for 3 columns"),
            ({"step": STEP, "names": ["x", "y", "z"]}, "expected no names"),
            ({"step": STEP, "loads": rows}, "expected no loads"),
            ({"step": STEP, "max_order": 3}, "max_order"),
            ({"step": STEP, "max_order": 200}, r"\[modes\] max_order")):
        with pytest.raises(pinode.Error, match=sentence):
            pinode.identify_modes(wind, **given)
    with pytest.raises(pinode.Error, match="nowhere.csv"):
        pinode.identify_modes("nowhere.csv")
    # What is no data file by its name, by what is said of it.
    with pytest.raises(pinode.Error, match="nowhere"):
        pinode.identify_modes("nowhere", columns=["a1"])
    with pytest.raises(pinode.Error, match="expected no columns"):
        pinode.identify_modes(rows, step=STEP, columns=["a1"])
    with pytest.raises(pinode.Error, match="expected no time"):
        pinode.identify_modes(pinode.read_case(CASE), time="t")


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
    with pytest.raises(pinode.Error, match=r"identify_modes: max_order: record 'record'.*200"):
        pinode.identify_modes(rows, step=STEP, max_order=200)
    with pytest.raises(pinode.Error, match="method"):
        pinode.identify_modes(rows, step=STEP, method="magic")
    with pytest.raises(pinode.Error, match="no measured load"):
        pinode.identify_modes(rows, step=STEP, method="input_output")
    with pytest.raises(pinode.Error, match="references is the text 'a1', expected a list"):
        pinode.identify_modes(rows, step=STEP, references="a1")
    with pytest.raises(pinode.Error, match="loads"):
        pinode.identify_modes(rows, step=STEP, loads=[1.0, 2.0])
    with pytest.raises(pinode.Error, match="free_decay"):
        pinode.identify_modes(rows, step=STEP, free_decay="yes")
    with pytest.raises(pinode.Error, match="nowhere.toml"):
        pinode.identify_modes("nowhere.toml")


def test_a_transposed_array_is_named(rows):
    with pytest.raises(pinode.Error, match="^records is 3 x 20000, expected samples x channels; if "
                       r"each row is a channel, pass its transpose, records\.T$"):
        pinode.identify_modes(rows.T, fs=50.0)
    with pytest.raises(pinode.Error, match=r"^records\['wing'\]\['values'\] is 3 x 20000"):
        pinode.identify_modes({"wing": {"values": rows.T, "fs": 50.0}})


def test_wrong_names_and_keys_of_arrays_are_named(rows):
    with pytest.raises(pinode.Error, match="^names has 1 name and records 3 channels"):
        pinode.identify_modes(rows, fs=50.0, names=["a"])
    with pytest.raises(pinode.Error, match=r"^records\['a'\] has no key 'fss'; did you mean 'fs'"):
        pinode.identify_modes({"a": {"values": rows, "fss": 50.0}})
    with pytest.raises(pinode.Error, match="^records has texts, expected numbers"):
        pinode.identify_modes(rows[:9].astype(str), fs=50.0)
    with pytest.raises(pinode.Error, match="^records is empty, expected samples x channels"):
        pinode.identify_modes([], fs=50.0)
    with pytest.raises(pinode.Error, match="^quantity is a list of 1 and records has 3 channels"):
        pinode.identify_modes(rows, fs=50.0, quantity=["acceleration"])
    with pytest.raises(pinode.Error, match="time is an array of 20000, .* arrays take step or fs"):
        pinode.identify_modes(rows, time=STEP * np.arange(len(rows)))
    with pytest.raises(pinode.Error, match="threads is the number -1, expected a whole number, 0"):
        pinode.identify_modes(rows, fs=50.0, threads=-1)


@pytest.mark.parametrize("keys, message", [
    ({"method": "fft"}, "^identify_modes: 'method' is 'fft', expected one of automatic, "),
    ({"max_order": 5}, "^identify_modes: 'max_order' is odd"),
    ({"references": ["x"]}, "^identify_modes: references: reference 'x' is not a channel"),
    ({"lowest_hz": 60.0}, "^identify_modes: lowest_hz: record 'record' is searched for modes"),
])
def test_wrong_options_of_arrays_name_the_function(rows, keys, message):
    with pytest.raises(pinode.Error, match=message):
        pinode.identify_modes(rows[:3000], fs=50.0, **keys)


def test_the_rate_is_a_step_or_a_frequency(rows):
    found = [pinode.identify_modes(rows[:6000], **keys, max_order=12).frequencies_hz for keys in (
        {"step": STEP}, {"fs": 50}, {"sampling_rate_hz": 50.0})]
    of_setup = pinode.identify_modes({"one": {"values": rows[:6000], "fs": 50.0}}, max_order=12)
    for other in (*found, of_setup.frequencies_hz):
        assert np.allclose(other, found[0], rtol=1e-9)
    with pytest.raises(pinode.Error, match="'step' and 'fs' are given, expected one of them"):
        pinode.identify_modes(rows, step=STEP, fs=50.0)


def test_harmonics_are_kept_or_left_out(rows):
    time = STEP * np.arange(len(rows))
    machine = 0.5 * rows.std() * np.sin(2 * np.pi * 8.0 * time)
    shaken = rows + machine[:, None]
    without = pinode.identify_modes(shaken, step=STEP)
    (harmonic,) = [m for m in without if m["is_harmonic"]]
    assert harmonic["frequency_hz"] == pytest.approx(8.0, abs=0.01)
    assert any("set harmonics=True" in remark for remark in without.remarks)
    assert not any("[modes]" in remark for remark in without.remarks)
    kept = pinode.identify_modes(shaken, step=STEP, harmonics=True)
    counts = [len(found.for_case()) for found in (without, kept)]
    assert counts == [len(without) - 1, len(kept)] and len(kept) == len(without)


def test_drift_and_noise_are_taken_away_on_request(rows):
    time = STEP * np.arange(len(rows))
    drift = 40.0 * rows.std() * (1.0 + time / time[-1])
    low, _, high = truth()
    found = pinode.identify_modes(rows + drift[:, None], step=STEP, detrend=True)
    assert_found(found)
    found = pinode.identify_modes(rows + drift[:, None], step=STEP, detrend="linear",
                                  filter_hz=(0.5 * low, 1.2 * high))
    assert_found(found)
    # A line is taken away to the last digits, a constant as the mean.
    from pinode._conditioned import conditioned
    line = np.column_stack([3.0 + 2.0 * time, -time])
    assert np.abs(conditioned("r", line, STEP, "linear", None)).max() < 1e-9 * time[-1]
    assert np.abs(conditioned("r", line, STEP, "constant", None).mean(axis=0)).max() < 1e-9
    # A sine in the band stays as it is, one outside goes.
    sines = np.sin(2 * np.pi * np.outer(time, [3.0, 20.0]))
    rest = conditioned("r", sines, STEP, None, (1.0, 6.0))[500:-500]
    assert np.abs(rest[:, 0] - sines[500:-500, 0]).max() < 0.02
    assert np.abs(rest[:, 1]).max() < 1e-3


@pytest.mark.parametrize("keys, message", [
    ({"detrend": "cubic"}, "detrend is the text 'cubic', expected True"),
    ({"filter_hz": 3.0}, "filter_hz is a value of type float, expected a list"),
    ({"filter_hz": (3.0,)}, "filter_hz is not a pair"),
    ({"filter_hz": (5.0, 3.0)}, "expected 0 < lowest < highest"),
    ({"filter_hz": (1.0, 30.0)}, "30 Hz, expected less than half the sampling rate, 25 Hz"),
    ({"harmonics": "yes"}, "harmonics is a value of type str, expected True or False"),
])
def test_what_is_wrong_with_requests_is_said(rows, keys, message):
    with pytest.raises(pinode.Error, match=message):
        pinode.identify_modes(rows, step=STEP, **keys)
    with pytest.raises(pinode.Error, match="expected no detrend"):
        pinode.identify_modes(CASE, detrend=True)


def test_mac_and_decomposition(rows):
    modes = pinode.identify_modes(rows, step=STEP)
    values = modes.mac()
    assert values.shape == (3, 3) and np.allclose(np.diag(values), 1.0)
    assert np.allclose(values, values.T) and values[0, 1] < 0.2
    a, b = modes.shapes[:, 0], modes.shapes[:, 1]
    assert values[0, 1] == pytest.approx(
        abs(np.vdot(a, b)) ** 2 / (np.vdot(a, a) * np.vdot(b, b)).real)
    assert np.allclose(modes.mac(modes), values)
    for what in ("stabilisation", "spectra", "fdd", "shapes", "mac"):
        assert modes.plot(what).axes
    with pytest.raises(pinode.Error, match="what is the text 'waterfall', expected one of"):
        modes.plot("waterfall")
    with pytest.raises(pinode.Error, match="there is no record 'r'"):
        modes.plot("fdd", "r")
    with pytest.raises(pinode.Error, match="other is the number 3, expected identified modes"):
        modes.mac(3)
