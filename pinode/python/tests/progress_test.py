"""The bar: when there is one, what it says, and that it ends."""

import re
import signal
import subprocess
import sys
import textwrap
import types

import pytest
import study_test

import pinode
from pinode.progress import watched

tqdm = pytest.importorskip("tqdm")


@pytest.fixture
def bars(monkeypatch):
    """Those that were made; they draw nothing."""
    made = []

    class Bar(tqdm.tqdm):
        def __init__(self, *args, **kwargs):
            super().__init__(*args, **kwargs)
            self.words, self.counts, self.closed = [], [], False
            made.append(self)

        def display(self, msg=None, pos=None):
            return True

        def update(self, n=1):
            self.words.append(f"{self.desc} {self.postfix}")
            super().update(n)
            self.counts.append(self.n)

        def close(self):
            super().close()
            self.closed = True

    monkeypatch.setattr("tqdm.auto.tqdm", Bar)
    return made


def test_silent_unless_asked_where_there_is_no_terminal(healthy, capfd):
    healthy.identify()
    healthy.identify(progress=False)
    written = capfd.readouterr()
    assert written.err == "" and written.out == ""
    healthy.identify(progress=True)
    written = capfd.readouterr()
    assert "identify" in written.err and "iterations" in written.err and written.out == ""
    shown = [line.strip() for line in written.err.split("\r") if "stage" in line]
    assert all(re.fullmatch(r"stage 1 of 1, \d+ iterations? in \d\d:\d\d, simulation error \S+ %, "
                            r"cost \S+", line) for line in shown), shown
    # It leaves nothing behind.
    assert written.err.split("\r")[-1].strip() == ""


def test_a_terminal_has_one_unless_it_is_not_wanted(healthy, bars, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    healthy.identify()
    assert len(bars) == 1
    healthy.identify(progress=False)
    assert len(bars) == 1


class Shell:
    """What IPython has running: in a notebook with the application of its kernel."""

    def __init__(self, *applications):
        self.config = dict.fromkeys(applications, {})


@pytest.mark.parametrize("shell, expected", [
    (Shell("IPKernelApp"), 1), (Shell("TerminalIPythonApp"), 0), (object(), 0), (None, 0)],
    ids=["notebook", "terminal", "unknown", "none"])
def test_a_notebook_has_one(shell, expected, healthy, bars, monkeypatch):
    monkeypatch.setitem(sys.modules, "IPython", types.SimpleNamespace(get_ipython=lambda: shell))
    monkeypatch.setattr(sys.stderr, "isatty", lambda: False, raising=False)
    healthy.identify()
    assert len(bars) == expected
    healthy.identify(progress=False)
    assert len(bars) == expected


def test_in_a_notebook_it_is_a_notebooks():
    """tqdm.auto takes widgets where there are some, by the same sign."""
    script = """
        import sys, types
        from unittest.mock import MagicMock
        widgets = sys.modules["ipywidgets"] = MagicMock(__version__="8.0.0")
        class Box:
            layout = MagicMock()
            def __init__(self, children): self.children = children
            def close(self): pass
        widgets.HBox = Box
        shell = types.SimpleNamespace(config={"IPKernelApp": {}})
        sys.modules["IPython"] = types.SimpleNamespace(
            get_ipython=lambda: shell, version_info=(8, 0, 0), __version__="8.0.0")
        sys.modules["IPython.display"] = types.SimpleNamespace(display=lambda *a: None)
        from pinode.progress import watched
        with watched(None, None) as call:
            call({"fit": "", "stage": 1, "num_stages": 1, "cost": 1.0,
                  "free_run_error": 0.1, "iteration": 1})
        import tqdm.auto, tqdm.notebook
        print(issubclass(tqdm.auto.tqdm, tqdm.notebook.tqdm), widgets.FloatProgress.call_count)
    """
    done = subprocess.run([sys.executable, "-W", "error", "-c", textwrap.dedent(script)],
                          capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("True 1\n", "")


def test_in_a_notebook_without_widgets_it_is_a_terminals():
    script = """
        import sys, types
        sys.modules["ipywidgets"] = None
        shell = types.SimpleNamespace(config={"IPKernelApp": {}})
        sys.modules["IPython"] = types.SimpleNamespace(get_ipython=lambda: shell)
        from pinode.progress import watched
        with watched(None, None) as call:
            call({"fit": "", "stage": 1, "num_stages": 1, "cost": 1.0,
                  "free_run_error": 0.1, "iteration": 1})
        import tqdm.auto, tqdm.std
        print(tqdm.auto.tqdm.__mro__[1] is tqdm.std.tqdm)
    """
    done = subprocess.run([sys.executable, "-W", "always", "-c", textwrap.dedent(script)],
                          capture_output=True, text=True)
    assert done.stdout == "True\n" and "Warning" not in done.stderr
    assert "identify" in done.stderr and not done.stderr.splitlines()[-1].strip()


def test_counts_the_iterations_beside_a_callback(healthy, bars):
    seen = []
    fit = healthy.identify(progress=True, callback=seen.append)
    assert fit.termination == "converged"
    (bar,) = bars
    assert bar.closed and len(bar.counts) == len(seen)
    assert bar.counts[-1] == max(state["iteration"] for state in seen)
    assert bar.counts == sorted(bar.counts)
    assert bar.words[-1].startswith("stage 1 of 1")
    assert f"cost {seen[-1]['cost']:.4g}" in bar.words[-1]
    assert "simulation error" in bar.words[-1]


def test_counts_on_where_another_fit_begins(bars):
    state = {"fit": "refit", "stage": 1, "num_stages": 1, "cost": 1.0, "free_run_error": 0.1}
    with watched(True, None) as call:
        for iteration in (0, 1, 3, 3, 0, 1, 1, 2, 1):
            assert call({**state, "iteration": iteration}) is None
    assert bars[0].counts == [0, 1, 3, 3, 3, 4, 4, 5, 6]


def test_of_verdicts_and_equations(damaged, baseline, bars):
    damaged.damage([baseline], progress=True)
    fit = study_test.oscillator(
        networks=[pinode.Network("nn", ["x[u1]", "v[u1]"], ["u1"], layers=[8])],
        options={"max_iterations": 60}).identify(progress=True)
    fit.discover(progress=True)
    assert len(bars) == 3 and all(bar.closed and bar.counts for bar in bars)
    assert bars[2].words[0].startswith("refit, stage")


def test_ends_with_the_fit_however_that_ends(healthy, damaged, bars):
    def fail(state):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        healthy.identify(progress=True, callback=fail)
    stopped = healthy.identify(progress=True, callback=lambda state: state["iteration"] < 2)
    assert stopped.termination == "interrupted"

    def press(state):
        if state["iteration"] == 2:
            signal.raise_signal(signal.SIGINT)

    pressed = healthy.identify(progress=True, callback=press)
    assert pressed.termination == "interrupted"
    with pytest.raises(pinode.Error, match="no baseline"):
        damaged.damage([], progress=True)
    assert len(bars) == 4 and all(bar.closed for bar in bars)
    with pytest.raises(KeyboardInterrupt):
        with watched(True, None):
            raise KeyboardInterrupt
    assert bars[-1].closed and len(bars) == 5


def test_without_tqdm_there_is_none(healthy, monkeypatch, capfd):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    seen = []
    healthy.identify(progress=True, callback=seen.append)
    assert seen and capfd.readouterr().err == ""
