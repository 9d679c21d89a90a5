#!/usr/bin/env python3
"""The small files of arrays on which the readers of pinode/base/arrays/array_files.h
are tested, and from which their fuzzers start, as NumPy, SciPy and h5py write
them (Debian: python3-scipy, python3-h5py).

Run from the project's root and commit what it writes:

    python3 tests/generators/array_files.py tests/fuzz/corpus/arrays

All of them hold one record of seven samples at 100 Hz: t, a of one column, y
of three, y[k, c] = (c + 1) sin(0.5 k + c), the third sample of a missing.
"""

import os
import sys

import h5py
import numpy as np
import scipy.io

T = 0.01 * np.arange(7)
Y = np.array([[(c + 1) * np.sin(0.5 * k + c) for c in range(3)]
              for k in range(7)])
A = np.cos(T)
A[2] = np.nan


def numpy_files(folder):
    np.save(os.path.join(folder, "y.npy"), Y)
    np.save(os.path.join(folder, "y_rows.npy"), np.asfortranarray(Y.T))
    np.savez(os.path.join(folder, "record.npz"), t=T, a=A, y=Y, rate=100.0,
             names=np.array(["u1", "u2"]), z=Y + 1j)
    np.savez_compressed(os.path.join(folder, "types.npz"), t=T.astype(">f4"),
                        y=np.round(1000 * Y).astype(np.int16))
    # The archives' dates change with every run; the arrays do not.


def matlab_files(folder):
    variables = {"t": T.reshape(-1, 1), "a": A, "y": Y, "rate": 100.0,
                 "data": {"acc": Y.T, "info": {"unit": "m/s^2", "b": A}},
                 "z": Y + 1j, "note": "a record", "cube": np.zeros((2, 3, 4))}
    for name, compressed in [("record", False), ("compressed", True)]:
        path = os.path.join(folder, name + ".mat")
        scipy.io.savemat(path, variables, do_compression=compressed)
        with open(path, "rb") as file:
            content = file.read()
        text = b"MATLAB 5.0 MAT-file, as SciPy writes it".ljust(116)
        with open(path, "wb") as file:
            file.write(text + content[116:])


def matlab_containers(folder):
    """Structures and cells as measuring programs leave them: several events of
    one structure, channels in cells, cells of structures."""
    events = np.zeros((1, 2), dtype=[("t", object), ("acc", object)])
    for i in range(2):
        events[0, i] = (T.reshape(-1, 1), (i + 1) * Y)
    cells = np.empty((2, 2), dtype=object)
    cells[0, 0], cells[1, 0] = Y, "a text"
    cells[0, 1], cells[1, 1] = np.zeros((0, 0)), {"y": Y.T, "unit": "g"}
    nested = np.empty((1, 1), dtype=object)
    nested[0, 0] = cells
    path = os.path.join(folder, "containers.mat")
    scipy.io.savemat(path, {"events": events, "cells": cells,
                            "data": {"channels": nested}})
    with open(path, "rb") as file:
        content = file.read()
    with open(path, "wb") as file:
        file.write(b"MATLAB 5.0 MAT-file, as SciPy writes it".ljust(116) +
                   content[116:])


def hdf5_files(folder):
    with h5py.File(os.path.join(folder, "record.h5"), "w") as file:
        file["t"] = T
        group = file.create_group("setup1")
        group.create_dataset("y", data=Y, chunks=(4, 3), compression="gzip",
                             track_times=False)
        group.create_dataset("raw", data=np.round(1000 * Y.T).astype(">i2"),
                             track_times=False)
        file["rate"] = 100.0
        file["name"] = "a record"
        table = np.zeros(7, dtype=[("t", "<f8"), ("a", "<f4")])
        table["t"], table["a"] = T, A
        file["table"] = table
    # Never written, and larger than any file.
    with h5py.File(os.path.join(folder, "huge.h5"), "w") as file:
        file["t"] = T
        file.create_dataset("empty", shape=(10 ** 12,), chunks=(10 ** 6,),
                            dtype="<f8", track_times=False)


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    numpy_files(folder)
    matlab_files(folder)
    matlab_containers(folder)
    hdf5_files(folder)


main()
