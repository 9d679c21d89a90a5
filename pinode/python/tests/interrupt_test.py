"""Ctrl-C: seen at once where no fit runs; a fit ends with its best values, and the
second press raises."""

import os
import pathlib
import signal
import subprocess
import sys
import textwrap
import threading
import time

import frame_testing
import numpy as np
import pytest
import study_test

import pinode

RANDOM = np.random.default_rng(1)


def hardening(samples, substeps=100):
    """A case of a few seconds' work: a hardening spring, in many small steps."""
    return pinode.Case(
        pinode.Model(frame_testing.MASS, frame_testing.STIFFNESS, frame_testing.DAMPING),
        groups=[pinode.Group("k1", frame_testing.STOREYS[0])],
        elements=[pinode.Element("spring", "cubic", ("ground", "u1"),
                                 {"k3": pinode.Unknown(1e6)})],
        records=[pinode.Record(
            "long", step=frame_testing.STEP, ground={"x": RANDOM.standard_normal(samples)},
            interpolation="linear", start="rest", substeps=substeps,
            channels=pinode.channels("a", RANDOM.standard_normal((samples, 3)),
                                     "absolute_acceleration"))])


def simulate():
    return hardening(6000, substeps=250).simulate


def read():
    return lambda: hardening(20000, substeps=250)


def check():
    return hardening(3000).check


def plan_sensors():
    case = hardening(3000)
    return lambda: case.plan_sensors(2)


def identify_modes():
    records = RANDOM.standard_normal((20000, 16))
    return lambda: pinode.identify_modes(records, step=0.01)


def seconds_to_interrupt(work, handler=None):
    """From the signal to what it raises, where `work` lasts longer."""
    sent = []

    def press():
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    before = signal.signal(signal.SIGINT, handler or signal.default_int_handler)
    timer = threading.Timer(0.2, press)
    timer.start()
    try:
        with pytest.raises(KeyError if handler else KeyboardInterrupt):
            work()
        return time.perf_counter() - sent[0]
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)


def test_the_interpreter_ends_when_the_work_does():
    script = textwrap.dedent("""
        import os, signal, threading, numpy as np, pinode
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        try:
            pinode.identify_modes(np.random.rand(15000, 12), step=0.01)
        except KeyboardInterrupt:
            print("seen")
    """)
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                          timeout=120)
    assert (done.returncode, done.stdout, done.stderr) == (0, "seen\n", "")


def discover():
    """Of smoothed records, with many candidates and many draws of each."""
    return study_test.oscillator(
        networks=[pinode.Network("nn", ["x[u1]", "v[u1]"], ["u1"], layers=[8])],
        discover={"source": "derivatives", "polynomial_degree": 6, "bags": 100,
                  "refit": False}).discover


@pytest.mark.parametrize("work", [simulate, read, check, plan_sensors, identify_modes, discover])
def test_is_seen_at_once(work):
    assert seconds_to_interrupt(work()) < 0.5


def test_what_a_handler_raises():
    def fail(number, frame):
        raise KeyError("mine")

    assert seconds_to_interrupt(check(), fail) < 0.5


def test_leaves_no_folder_and_a_case_that_works(tmp_path):
    case = hardening(3000)
    seconds_to_interrupt(lambda: case.check(output=tmp_path / "out"))
    assert not list(tmp_path.iterdir())
    assert set(case.parameters) == {"k1", "spring.k3"}


def test_errors_are_as_ever(healthy):
    with pytest.raises(pinode.Error, match="too short"):
        pinode.identify_modes(RANDOM.standard_normal((10, 1)), step=0.1)
    with pytest.raises(pinode.Error, match="^a record has no force, expected one to place"):
        healthy.plan_sensors(1, force_at="u9")


ENDLESS = """
import os, signal, sys, threading, time, pinode
case = pinode.read_case(sys.argv[1]).replace(options={"tolerance": 1e-300})
def press(state):
    '''From outside, in the midst of each fit.'''
    if state["iteration"] == 1:
        threading.Timer(0.01, os.kill, (os.getpid(), signal.SIGINT)).start()
"""


def of_script(script):
    path = pathlib.Path(os.environ["PINODE_SOURCE_DIR"]) / "data/three_storey/three_storey.toml"
    done = subprocess.run([sys.executable, "-c", ENDLESS + textwrap.dedent(script), path],
                          capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.split()


def test_the_second_press_ends_a_loop_of_fits():
    assert of_script("""
        fits = []
        try:
            while True:
                fits.append(case.identify(callback=press))
        except KeyboardInterrupt:
            print(fits[0].termination)
        """) == ["interrupted"]


def test_the_second_press_in_a_fit_does_not_wait_for_it():
    """The callback, which presses twice, is the last that the fit hears."""
    assert of_script("""
        pressed = []
        def call(state):
            pressed.append(state["iteration"])
            signal.raise_signal(signal.SIGINT)
        for number in range(2):
            try:
                print(case.identify(callback=call).termination)
            except KeyboardInterrupt:
                print("raised")
        print(len(pressed))
        """) == ["interrupted", "raised", "2"]


def test_what_was_given_up_writes_no_folder(tmp_path):
    folder = tmp_path / "out"
    assert of_script(f"""
        case.identify(callback=press)
        try:
            case.identify(callback=press, output={str(folder)!r})
        except KeyboardInterrupt:
            print("raised")
        """) == ["raised"]
    assert not folder.exists()
