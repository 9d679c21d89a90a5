#!/usr/bin/env python3
"""The small files of frequency response functions from which the fuzzer of
pinode/record/frf starts. They are written from the formats' descriptions, with
nothing of the readers.

Run from the project's root and commit what it writes:

    python3 tests/generators/frf_files.py tests/fuzz/corpus

All hold accelerances of a mass with two receivers, H = -w^2 / (1 - w^2 + 0.1 i
w) times 1 and -0.5, at 12 lines.
"""

import cmath
import math
import os
import sys

from logger_files import write
from text_files import block

N = 12


def accelerance(receiver, k):
    w = 0.2 * k
    return (-w * w / (1 - w * w + 0.1j * w)) * (1.0, -0.5)[receiver]


def text_files(folder):
    write(folder, "real.txt", (
        "Units: Ratio\r\nRef Chan:Resp Chan\t0-Z:0-Z\r\n\r\n"
        "Frequency\t Real\t Imaginary\r\n\r\nUnits:\r\nHz\t(m/s\xb2)(N)\t \r\n" +
        "".join("%.6e\t %.6g\t %.6g\r\n" % (
            0.5 * k, accelerance(0, k).real, accelerance(0, k).imag)
            for k in range(N))).encode("latin-1"))
    write(folder, "decibels.txt", "Frequency\tMagnitude\tPhase\t\n" + "".join(
        "%.1f\t%.4f\t%.3f\n" % (
            0.5 * k, 20 * math.log10(abs(accelerance(1, k))),
            math.degrees(cmath.phase(accelerance(1, k))))
        for k in range(1, N)))
    write(folder, "coherence.csv", "# hammer\nfreq;ampl (m/s^2/N);phase;coh\n" +
          "".join("%.1f;%.5f;%.4f;%.2f\n" % (
              0.5 * k, abs(accelerance(0, k)),
              cmath.phase(accelerance(0, k)), 1 - 0.01 * k)
              for k in range(N)))
    # The second header has fewer columns.
    write(folder, "two_headers.txt",
          "freq;name;magnitude;phase\nfreq;real;imag\n1;2;3\n2;4;5\n")


def function(kind, receiver, even, data_type, texts=(), direction=3):
    """Data set 58 of function type 4 (FRF) or 6 (coherence)."""
    lines = ["accelerance", *texts, *["NONE"] * (4 - len(texts))]
    name = "NONE"
    lines.append("%5d%10d%5d%10d %-10s%10d%4d %-10s%10d%4d" % (
        kind, 1, 1, 0, name, 1 + receiver, -3 if receiver else direction, name,
        1, direction))
    lines.append("%10d%10d%10d%13.5e%13.5e%13.5e" % (
        data_type, N, 1 if even else 0, 0.0, 0.5 if even else 0.0, 0.0))
    for axis in ((18, "Frequency", "Hz"), (12, "Motion", "m/s^2"),
                 (13, "Force", "N"), (0, "NONE", "NONE")):
        lines.append("%10d%5d%5d%5d %-20s %-20s" % (
            axis[0], 0, 0, 0, axis[1], axis[2]))
    numbers = []
    for k in range(N):
        if not even:
            numbers.append(0.5 * k)
        value = accelerance(receiver, k) if kind == 4 else 1 - 0.01 * k
        numbers.append(value.real)
        if data_type in (5, 6):
            numbers.append(value.imag)
    form, per_line = ("%20.12e", 4) if data_type in (4, 6) else ("%13.5e", 6)
    for i in range(0, len(numbers), per_line):
        lines.append("".join(form % v for v in numbers[i:i + per_line]))
    return block(("    58\n" + "\n".join(lines) + "\n").encode())


def universal_files(folder):
    write(folder, "two.uff", function(4, 0, True, 6) + function(4, 1, True, 6))
    write(folder, "coherence.uff",
          function(4, 0, True, 5) + function(6, 0, True, 2))
    write(folder, "scalar.uff", function(4, 0, True, 5, direction=0))
    write(folder, "uneven.uff", function(
        4, 1, False, 6, ("NONE", "NONE", "exponential window 0.25 1/s")))


def main():
    folder = os.path.join(sys.argv[1], "frf")
    text_files(folder)
    universal_files(folder)


if __name__ == "__main__":
    main()
