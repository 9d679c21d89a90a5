#!/usr/bin/env python3
"""Reference values for pinode/record/filter_test.cc, by SciPy's sosfiltfilt.

Run from the project's root and commit what it prints:

    python3 tests/generators/zero_phase_filter.py \
        > pinode/record/filter_reference.inc
"""

import numpy as np
from scipy.signal import butter, sosfiltfilt

NUM_SAMPLES = 150
STRIDE = 5
RATE = 120.0

# type, corners (Hz), order, samples
CASES = [
    ("kLowPass", [30.0], 4, NUM_SAMPLES),
    ("kLowPass", [10.0], 1, NUM_SAMPLES),
    ("kLowPass", [25.0], 3, NUM_SAMPLES),
    ("kHighPass", [2.0], 2, NUM_SAMPLES),
    ("kHighPass", [20.0], 5, NUM_SAMPLES),
    ("kBandPass", [0.8, 30.0], 4, NUM_SAMPLES),
    ("kBandPass", [5.0, 8.0], 3, NUM_SAMPLES),
    ("kBandPass", [2.0, 50.0], 1, NUM_SAMPLES),
    # Shorter than SciPy's own padding: the longest reflection that there is.
    ("kLowPass", [30.0], 4, 9),
]
KINDS = {"kLowPass": "lowpass", "kHighPass": "highpass",
         "kBandPass": "bandpass"}


def history(num_samples):
    """Integers in [-500, 500] without a pattern, from integers alone."""
    i = np.arange(num_samples, dtype=np.int64)
    return ((i * i * 7919 + i * 104729 + 17) % 1001 - 500).astype(float)


def main():
    print("// Made by tests/generators/zero_phase_filter.py. Each case: type, "
          "corners (Hz),\n// order, samples, every fifth filtered value.")
    print("// clang-format off")
    for kind, corners, order, num_samples in CASES:
        sos = butter(order, corners if len(corners) > 1 else corners[0],
                     btype=KINDS[kind], fs=RATE, output="sos")
        default = 3 * (2 * len(sos) + 1 -
                       min((sos[:, 2] == 0).sum(), (sos[:, 5] == 0).sum()))
        padding = min(int(default), num_samples - 1)
        y = sosfiltfilt(sos, history(num_samples), padlen=padding)
        numbers = ", ".join("%.15g" % v for v in y[::STRIDE])
        print("{FilterType::%s, {%s}, %d, %d,\n {%s}},"
              % (kind, ", ".join("%g" % c for c in corners), order,
                 num_samples, numbers))
    print("// clang-format on")


if __name__ == "__main__":
    main()
