"""Fits, what they say, and what goes with them."""

import json
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import threading

import conftest
import frame_testing
import numpy as np
import pytest
import scipy.io

import pinode

DATA = pathlib.Path(os.environ["PINODE_SOURCE_DIR"]) / "data"


def test_finds_the_storeys(damaged):
    fit = damaged.identify()
    assert fit.usable and fit.termination == "converged"
    for name, truth in (("k1", -0.1), ("k2", 0.0), ("k3", 0.0)):
        parameter = fit.parameters[name]
        assert parameter.free and parameter.unit == "1"
        assert abs(parameter.value - truth) < 4 * parameter.sigma
        assert parameter.sigma < 0.005
    expected = frame_testing.STIFFNESS + sum(
        fit[f"k{i + 1}"] * matrix for i, matrix in enumerate(frame_testing.STOREYS))
    assert np.allclose(fit.stiffness, expected, rtol=1e-12)
    names = fit.covariance_names
    assert np.sqrt(fit.covariance[names.index("k1"), names.index("k1")]) == (
        pytest.approx(fit.parameters["k1"].sigma))


def test_predictions_are_those_of_the_scores(baseline):
    record = baseline.record("healthy")
    scores = baseline.records["healthy"]["channels"]
    for score in scores:
        name = score["name"]
        error = record.measured[name] - record.predicted[name]
        assert np.sqrt(np.mean(error**2)) == pytest.approx(score["rmse"], rel=1e-9)
        inside = np.abs(error) < 1.96 * record.deviation[name]
        assert 0.9 < np.mean(inside) <= 1.0
    assert record.states.shape == (6, 1500)
    with pytest.raises(pinode.Error, match="no record 'nowhere'"):
        baseline.record("nowhere")


def test_is_what_the_program_finds(tmp_path):
    program = os.environ.get("PINODE_UPDATE")
    if not program:
        pytest.skip("the programs are not built")
    case = DATA / "three_storey" / "three_storey.toml"
    subprocess.run([program, f"--case={case}", f"--output_dir={tmp_path / 'out'}",
                    "--noprogress"], check=True, stdout=subprocess.DEVNULL)
    theirs = pinode.read_result(tmp_path / "out")
    fit = pinode.read_case(case).identify()
    assert fit.usable and theirs.usable
    for key in ("parameters", "records", "modes", "termination", "message"):
        assert fit.json[key] == theirs.json[key]


def test_writes_what_the_programs_write(baseline, tmp_path):
    baseline.save(tmp_path / "out")
    with pytest.raises(pinode.Error, match="exists"):
        baseline.save(tmp_path / "out")
    baseline.save(tmp_path / "out", overwrite=True)
    folder = pinode.read_result(tmp_path / "out")
    assert folder.usable and folder["k1"] == baseline["k1"]
    assert np.array_equal(folder.matrix("K.mtx"), baseline.stiffness)
    prediction = folder.prediction("healthy")
    assert np.allclose(prediction["a1_predicted"],
                       baseline.record("healthy").predicted["a1"], rtol=1e-12)
    assert "healthy" in folder.case.records
    assert (tmp_path / "out" / "report.html").stat().st_size > 10000


def test_output_is_written_with_the_fit(healthy, tmp_path):
    fit = healthy.identify(output=tmp_path / "out")
    assert pinode.read_result(tmp_path / "out")["k1"] == fit["k1"]
    with pytest.raises(pinode.Error, match="exists"):
        healthy.identify(output=tmp_path / "out")


def test_results_for_matlab(healthy, tmp_path):
    fit = healthy.identify(output=tmp_path / "out", mat=True)
    fit.save(tmp_path / "again", mat=True)
    for name in ("out", "again"):
        results = scipy.io.loadmat(tmp_path / name / "results.mat", simplify_cells=True)
        assert np.allclose(results["parameters"]["value"][0], fit["k1"])


def test_zero_bytes_do_not_end_a_sentence(healthy):
    with pytest.raises(pinode.Error, match=r"x00.*expected"):
        healthy.damage(["\0"])


def test_what_is_no_result_is_refused(tmp_path):
    with pytest.raises(pinode.Error, match="is not a result of pinode"):
        pinode.read_result(tmp_path)
    (tmp_path / "result.json").write_text("[1]")
    with pytest.raises(pinode.Error, match="is not a result of pinode"):
        pinode.read_result(tmp_path)


def test_is_pickled(baseline):
    other = pickle.loads(pickle.dumps(baseline))
    assert other.json == baseline.json
    ours, theirs = baseline.record("healthy"), other.record("healthy")
    assert np.array_equal(ours.states, theirs.states)
    assert np.array_equal(ours.predicted["a2"], theirs.predicted["a2"])
    assert np.array_equal(baseline.covariance, other.covariance)
    assert other.history["cost"].tolist() == baseline.history["cost"].tolist()
    state = list(baseline._handle.state())
    state[2] = state[2][:-9] + b"x" + state[2][-8:]
    with pytest.raises(pinode.Error, match="not a fit of that case"):
        pinode._pinode.FitHandle.from_state(*state)


def test_begins_from_another_fit(healthy, baseline):
    seen = []

    def stop(state):
        seen.append(state["free_run_error"])
        return False

    healthy.identify(callback=stop)
    healthy.identify(callback=stop, begin_from=baseline)
    assert seen[1] <= seen[0]
    assert healthy.identify(begin_from=baseline)["k1"] == pytest.approx(
        baseline["k1"], abs=1e-6)
    others = healthy.replace(groups=conftest.groups()[:2])
    assert others.identify(begin_from=baseline).usable


def test_callbacks_see_and_stop(healthy):
    seen = []
    fit = healthy.identify(callback=seen.append)
    assert len(seen) >= 3 and seen[-1]["elapsed_seconds"] > 0.0
    assert {"stage", "cost", "free_run_error"} <= set(seen[0])
    assert fit.termination == "converged"

    def fail(state):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        healthy.identify(callback=fail)
    stopped = healthy.identify(callback=lambda state: state["iteration"] < 2)
    assert stopped.termination == "interrupted" and not stopped.usable


def test_interrupts_keep_the_best_so_far(healthy):
    def press(state):
        if state["iteration"] == 2:
            signal.raise_signal(signal.SIGINT)

    fit = healthy.identify(callback=press)
    assert fit.termination == "interrupted"
    assert set(fit.parameters) == {"k1", "k2", "k3"}
    # Without a callback, from outside.
    script = (
        "import os, signal, sys, threading, pinode\n"
        "case = pinode.read_case(sys.argv[1])\n"
        "case = case.replace(options={'tolerance': 1e-300})\n"
        "threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
        "print(case.identify().termination)\n")
    done = subprocess.run(
        [sys.executable, "-c", script, DATA / "three_storey" / "three_storey.toml"],
        capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.strip() == "interrupted"


def test_other_threads_run_meanwhile(healthy):
    running = threading.Event()
    fits = []
    thread = threading.Thread(
        target=lambda: fits.append(healthy.identify(callback=lambda s: running.set())))
    thread.start()
    assert running.wait(60)
    other = healthy.identify()
    thread.join()
    assert fits[0]["k1"] == other["k1"]


def test_profiles_of_the_likelihood(healthy):
    fit = healthy.replace(profiles={"parameters": ["k1"]}).identify()
    profile = fit.profiles["k1"]
    linear = fit.parameters["k1"]
    assert profile["determination"] == "determined"
    assert profile["lower95"] == pytest.approx(linear.lower95, abs=0.3 * linear.sigma)
    assert profile["upper95"] == pytest.approx(linear.upper95, abs=0.3 * linear.sigma)


def test_reprs(baseline):
    assert "k1" in str(baseline) and baseline.sentence.startswith("Good")
    assert "<td>k1</td>" in baseline._repr_html_()
    assert "Fit(" in repr(baseline)
    assert json.dumps(baseline.json)


def test_structure_in_a_page(healthy, baseline, tmp_path):
    assert baseline.structure() is None
    levels = {f"n{i}": [0.0, 0.0, 3.0 * i] for i in range(4)}
    placed = healthy.replace(geometry={
        "nodes": levels,
        "dofs": {dof: f"n{i + 1}.1" for i, dof in enumerate(healthy.dofs)},
        "line": [{"nodes": [f"n{i}", f"n{i + 1}"], "set": f"k{i + 1}"}
                 for i in range(3)]}).identify()
    view = placed.structure()
    view.save(tmp_path / "structure.html")
    page = (tmp_path / "structure.html").read_text(encoding="utf-8")
    assert page == view.html
    for part in ("<svg", "structure-data", "k1", "mode 1"):
        assert part in page
    assert view._repr_html_().startswith("<iframe")
    assert "<script" not in view._repr_html_()
    placed.save(tmp_path / "result")
    assert (tmp_path / "result" / "structure.vtu").exists()
    assert "structure-data" in (tmp_path / "result" / "report.html").read_text(
        encoding="utf-8")
