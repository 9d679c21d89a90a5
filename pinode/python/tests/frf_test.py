"""Frequency response functions: from records, and from their modes to a beam."""

import os
import pathlib
import pickle
import re

import numpy as np
import pinode
import pytest

SOURCE = pathlib.Path(os.environ["PINODE_SOURCE_DIR"])
PAGE = SOURCE / "pinode" / "case" / "first_case" / "frequency_responses.md"
FS = 100.0
RANDOM = np.random.default_rng(4)


def respond(force):
    """A discrete vibrator: y_k = 1.6 y_{k-1} - 0.9 y_{k-2} + x_k."""
    response = np.zeros(len(force))
    for k, value in enumerate(force):
        response[k] = value + 1.6 * response[k - 1] * (k > 0) - 0.9 * response[k - 2] * (k > 1)
    return response


def vibrator(hz):
    shift = np.exp(-2j * np.pi * hz / FS)
    return 1.0 / (1.0 - 1.6 * shift + 0.9 * shift**2)


def test_the_beam_of_the_page():
    """The depth and the modulus of a Timoshenko beam; a slender one is contradicted."""
    block = next(code for code in re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
                 if "def beam(" in code)
    names = {}
    exec(block, names)  # noqa: S102
    fit = names["timoshenko"]
    assert fit.verdict == "good", fit.sentence
    mass, stiffness = names["beam"](names["modulus"], names["depth"])
    squares = np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real
    found = np.sqrt(np.abs(np.sort(squares)))[2:6] / (2.0 * np.pi)
    assert np.abs(found - names["HZ"]).max() < 0.1
    assert names["slender"].verdict == "not_usable"
    assert names["slender"].findings[0]["check"] == "frequencies_far_off"


def test_random_force():
    force = RANDOM.standard_normal(8000)
    response = respond(force) + 0.1 * RANDOM.standard_normal(8000)
    found = pinode.estimate_frfs(force, response, fs=FS, block=5.12)
    assert found.values.shape == found.coherence.shape == (len(found.frequencies_hz), 1, 1)
    assert (found.responses, found.references) == (["a1"], ["f1"])
    exact = vibrator(found.frequencies_hz)
    errors = np.abs(found.values[:, 0, 0] - exact)
    assert np.mean(errors**2 / found.variances[:, 0, 0]) < 2.0
    assert np.median(errors / np.abs(exact)) < 0.05
    signal = pytest.importorskip("scipy.signal")
    lines, coherence = signal.coherence(force, response, fs=FS, nperseg=512)
    np.testing.assert_allclose(found.frequencies_hz, lines[1:-1], rtol=1e-12)
    np.testing.assert_allclose(found.coherence[:, 0, 0], coherence[1:-1], rtol=1e-9)


def test_blows_in_a_record_each(tmp_path):
    records = []
    for size in np.linspace(40.0, 90.0, 9):
        force = np.zeros(600)
        force[40:46] = size * np.sin(np.pi * (np.arange(6) + 0.5) / 6.0)
        records.append((force, respond(force)))
    records[3][0][100:103] = 20.0  # the hammer hits again
    found = pinode.estimate_frfs([one for one, _ in records], [other for _, other in records],
                                 step=0.01, names=["tip"], references=["root"])
    assert found.num_blocks == 8
    assert "hit again" in found.remarks[0]
    band = found.frequencies_hz < 20.0
    np.testing.assert_allclose(found.values[band, 0, 0], vibrator(found.frequencies_hz[band]),
                               rtol=1e-6)
    path = found.save(tmp_path / "frfs.uff")
    assert os.path.getsize(path) > 1000
    with pytest.raises(pinode.Error, match="universal file"):
        found.save(tmp_path / "frfs.csv")
    copy = pickle.loads(pickle.dumps(found))
    assert copy.num_blocks == 8
    with pytest.raises(pinode.Error, match="pickle"):
        copy.save(tmp_path / "copy.uff")


@pytest.mark.parametrize("given, message", [
    ({}, "'step' is missing, expected step=seconds or fs"),
    ({"fs": FS, "quantity": "strain"}, "expected acceleration"),
    ({"fs": FS, "estimator": "h3"}, "expected h1, h2 or hv"),
    ({"fs": FS, "excitation": "wind"}, "expected automatic, blows"),
    ({"fs": FS, "overlap": 1.5}, "overlap is 1.5"),
    ({"fs": FS, "block": 1e4}, "samples"),
    ({"fs": FS, "names": ["a", "b"]}, "names has 2 entries, expected 1"),
    ({"fs": FS, "exponential_window": 0.1}, "blows of a hammer"),
])
def test_mistakes_are_one_sentence(given, message):
    force = np.random.default_rng(1).standard_normal(500)
    with pytest.raises(pinode.Error, match=message) as caught:
        pinode.estimate_frfs(force, force, **given)
    assert "\n" not in str(caught.value)
    with pytest.raises(pinode.Error, match="complex"):
        pinode.estimate_frfs(1j * force, force, fs=FS)


def test_arrays_of_other_lengths_are_named():
    force, responses = np.ones(300), np.ones((300, 2))
    with pytest.raises(pinode.Error, match=r"^responses is 2 x 300 and force has 300 samples, .*"
                                           r"pass its transpose, responses\.T$"):
        pinode.estimate_frfs(force, responses.T, fs=100)
    with pytest.raises(pinode.Error, match="^responses is 300 x 2 and force has 200 samples, "
                                           "expected samples x channels, as many"):
        pinode.estimate_frfs(force[:200], responses, fs=100)
    with pytest.raises(pinode.Error, match="expected step=seconds or fs=samples a second"):
        pinode.estimate_frfs(force, responses)
