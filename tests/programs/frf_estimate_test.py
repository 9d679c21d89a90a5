#!/usr/bin/env python3
"""Frequency responses from records of a hammer, their modes, and a fit to them.

    tests/programs/frf_estimate_test.py PROGRAM_DIR

Three masses in a row are hit at the first one. The vibration is the exact
solution for a force that is linear between fine steps. Forces and responses pass
the same filter before they are sampled, as in a logger.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

SPRINGS = (4000.0, 3000.0, 2500.0)
RATIOS = np.array([0.03, 0.025, 0.02])
FINE_HZ = 2000.0
EVERY = 10  # fine steps a sample


def spring(storey, stiffness):
    """The stiffness matrix of one spring below a mass."""
    matrix = np.zeros((3, 3))
    matrix[storey, storey] = stiffness
    if storey > 0:
        matrix[storey - 1, storey - 1] = stiffness
        matrix[storey - 1, storey] = matrix[storey, storey - 1] = -stiffness
    return matrix


PARTS = [spring(storey, value) for storey, value in enumerate(SPRINGS)]
SQUARES, SHAPES = np.linalg.eigh(sum(PARTS))
OMEGA = np.sqrt(SQUARES)
DAMPING = SHAPES @ np.diag(2.0 * RATIOS * OMEGA) @ SHAPES.T


def blow(force, time, size):
    """A half sine of 12 ms."""
    count, first = int(0.012 * FINE_HZ), int(time * FINE_HZ)
    force[first:first + count] += size * np.sin(np.pi * (np.arange(count) + 0.5) / count)


def respond(force, place):
    """Accelerations of the masses, by convolution with the modes' impulse responses."""
    size = 2 * len(force)
    step = 1.0 / FINE_HZ
    spectrum = np.fft.rfft(force, size)
    times = step * np.arange(len(force))
    result = np.zeros((3, len(force)))
    for omega, ratio, shape in zip(OMEGA, RATIOS, SHAPES.T):
        pole = -ratio * omega + 1j * omega * np.sqrt(1.0 - ratio ** 2)
        # Weights of a force that is linear between steps.
        grown = np.exp(pole * step)
        own = (grown - 1.0 - pole * step) / (pole * pole * step)
        before = (grown - 1.0) / pole - own
        kernel = own * np.exp(pole * times)
        kernel[1:] += before * np.exp(pole * times[:-1])
        state = np.fft.irfft(np.fft.rfft(kernel.real, size) * spectrum)[:len(force)] + 1j * \
            np.fft.irfft(np.fft.rfft(kernel.imag, size) * spectrum)[:len(force)]
        q, v = state.imag / pole.imag, (pole * state).imag / pole.imag
        acceleration = force - 2.0 * ratio * omega * v - omega ** 2 * q
        result += np.outer(shape * shape[place], acceleration)
    return result


def sampled(rows):
    taps = np.arange(-100, 101)
    low_pass = np.sinc(taps * 160.0 / FINE_HZ) * np.hanning(201)
    low_pass /= low_pass.sum()
    return np.array([np.convolve(row, low_pass, "same")[::EVERY] for row in np.atleast_2d(rows)])


def hammer_test(seed, blows=12, place=0, again=(), noise=0.003, apart=4.0):
    """Samples of the force and the three responses."""
    random = np.random.default_rng(seed)
    force = np.zeros(int((1.0 + apart * blows) * FINE_HZ))
    for i in range(blows):
        blow(force, 0.5 + apart * i, random.uniform(60.0, 120.0))
    for time, size in again:
        blow(force, time, size)
    rows = sampled(np.vstack([force, respond(force, place)]))
    rows[0] += 0.02 * random.standard_normal(rows.shape[1])
    for row in rows[1:]:
        row += noise * row.std() * random.standard_normal(len(row))
    return rows


def write_case(folder, rows, options="", place="u1"):
    folder.mkdir()
    times = np.arange(rows.shape[1]) * EVERY / FINE_HZ
    np.savetxt(folder / "h.csv", np.column_stack([times, *rows]), "%.9g", ",",
               header="t,f,a1,a2,a3", comments="")
    text = (f'[modes.frf]\n{options}\n[[record]]\nname = "hammer"\nfile = "h.csv"\ntime = "t"\n'
            f'interpolation = "linear"\n[[record.force]]\ndof = "{place}"\ncolumn = "f"\n'
            'unit = "N"\n')
    for i in (1, 2, 3):
        text += (f'[[record.channel]]\ncolumn = "a{i}"\ndof = "u{i}"\nunit = "m/s^2"\n'
                 'quantity = "relative_acceleration"\n')
    (folder / "modes.toml").write_text(text)
    return folder / "modes.toml"


def fit_case(folder, functions):
    text = ('[model]\ndofs = ["u1", "u2", "u3"]\nmass = {diagonal = [1.0, 1.0, 1.0]}\n'
            f"stiffness = {sum(PARTS).tolist()}\ndamping = {DAMPING.tolist()}\n")
    for i, part in enumerate(PARTS):
        text += f'[[group]]\nname = "k{i + 1}"\nadds_to = "stiffness"\nmatrix = {part.tolist()}\n'
    text += f'[[group]]\nname = "c"\nadds_to = "damping"\nmatrix = {DAMPING.tolist()}\n'
    text += f'[[frf]]\nname = "hammer"\nfiles = ["{functions}"]\nband_hz = [1.0, 25.0]\n'
    (folder / "fit.toml").write_text(text)
    return folder / "fit.toml"


def main():
    programs = pathlib.Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)

        def run(program, case, output, status=0):
            done = subprocess.run([programs / program, f"--case={case}", f"--output_dir={output}"],
                                  capture_output=True, text=True, check=False)
            assert done.returncode == status, done
            return done

        def modes(name, rows, **given):
            """Modes and remarks of a test."""
            case = write_case(scratch / name, rows, **given)
            run("pinode_modes", case, scratch / name / "out")
            found = json.loads((scratch / name / "out" / "modes.json").read_text())
            return found["modes"], " ".join(found["remarks"])

        def assert_true(found, ratio_within):
            assert len(found) == 3, found
            for mode, omega, ratio in zip(found, OMEGA, RATIOS):
                hz = omega / (2.0 * np.pi)
                assert abs(mode["frequency_hz"] / hz - 1.0) < 5e-4, (mode, hz)
                assert abs(mode["damping_ratio"] / ratio - 1.0) < ratio_within, (mode, ratio)

        # Long blocks; then short ones with a window, whose damping is corrected.
        found, remarks = modes("whole", hammer_test(1, apart=8.0))
        assert_true(found, 0.05)
        assert "of 12 blows" in remarks and "coherence" in remarks, remarks
        assert "opposite" not in remarks and "of its size" not in remarks, remarks
        assert "indicator" in (scratch / "whole" / "out" / "report.html").read_text()
        found, remarks = modes("window", hammer_test(2, apart=8.0),
                               options="exponential_window = 0.8\nforce_window = 0.1")
        assert_true(found, 0.1)

        # A fit to the functions that were written, and to those with a window.
        fitted = scratch / "fitted"
        run("pinode_update", fit_case(scratch, scratch / "whole" / "out" / "frfs.uff"), fitted)
        result = json.loads((fitted / "result.json").read_text())
        for parameter in result["parameters"]:
            assert abs(parameter["value"]) < 0.01, parameter
        refused = run("pinode_update",
                      fit_case(scratch, scratch / "window" / "out" / "frfs.uff"),
                      scratch / "refused", status=2)
        assert "exponential window" in refused.stderr, refused.stderr
        assert refused.stderr.count("\n") == 1, refused.stderr

        # The program says what spoils a test. A few blows show it.
        spoiled = hammer_test(3, blows=4, apart=8.0, again=[(16.6, 30.0)])
        spoiled[0] *= -1.0
        _, remarks = modes("spoiled", spoiled)
        assert "1 blow was left out: the hammer hit again" in remarks, remarks
        assert "sensor and hammer point in opposite directions" in remarks, remarks
        cut = hammer_test(4, blows=4, apart=8.0)
        cut[0] = np.minimum(cut[0], 0.85 * cut[0].max())
        _, remarks = modes("cut", cut)
        assert "the force or a response is cut off" in remarks, remarks
        _, remarks = modes("short", hammer_test(6, blows=3, apart=3.0),
                           options="exponential_window = 0.8")
        assert "when the next blow comes" in remarks, remarks
        assert "3 independent blocks" in remarks, remarks


main()
