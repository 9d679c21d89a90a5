#!/usr/bin/env python3
"""The small text files and universal files from which the fuzzers of
pinode/record/files start. They are written from the formats' descriptions, with
nothing of the readers.

Run from the project's root and commit what it writes:

    python3 tests/generators/text_files.py tests/fuzz/corpus

All hold y[c][k] = (c + 1) sin(0.5 k + c) at 100 Hz.
"""

import os
import struct
import sys

from logger_files import series, write, y

N = 12


def rows(form, delimiter=",", decimal=".", times=None, count=N, channels=2,
         end="\n"):
    text = ""
    for k in range(count):
        cells = [times(k)] if times else []
        cells += [(form % y(c, k)).replace(".", decimal)
                  for c in range(channels)]
        text += delimiter.join(cells) + end
    return text


def seconds(k):
    return "%.2f" % (0.01 * k)


def text_files(folder):
    write(folder, "plain.csv", "t,a1,a2\n" + rows("%.8f", times=seconds))
    write(folder, "german.csv", (
        "Logger ACME;SN 1;\r\nProjekt;Wägung;\r\n"
        "Zeit [s];CH0 Base [mg];CH1_Acc (mg)\r\n" +
        rows("%.5f", ";", ",", lambda k: seconds(k).replace(".", ","),
             end="\r\n")).encode("latin-1"))
    write(folder, "clock.csv", "Datum;Zeit;a\r\n" + rows(
        "%.5f", ";", ",",
        lambda k: "01.03.2024;12:00:%02d,%03d" % (k // 100, 10 * (k % 100)),
        channels=1))
    write(folder, "iso.csv", "timestamp,a1\n" + rows(
        "%.5f", times=lambda k: "2024-03-01T23:59:%02d.%06dZ" %
        (59, 80000 * k), channels=1))
    write(folder, "twelve_hours.csv", "Time,a\n" + rows(
        "%.4f", times=lambda k: "3/1/2024 12:59:%02d.%03d PM" %
        (k // 100 + 1, 10 * (k % 100)), channels=1))
    write(folder, "parts.txt", "NO.\tDate\tTime\tus\tV1\n" + "".join(
        "%d\t2020/01/24\t16:53:12\t%d\t%s %.5f\n" %
        (k + 1, 10000 * k, "-" if y(0, k) < 0 else "+", abs(y(0, k)))
        for k in range(N)))
    write(folder, "ticks.csv", '"ticks","a"\n' + rows(
        '"%.5f"', times=lambda k: '"%d"' % (638448912000000000 + 100000 * k),
        channels=1))
    write(folder, "wrap.csv", "ms,a\n" + rows(
        "%.5f", times=lambda k: str((1000 + 10 * k) % 1024), channels=1))
    write(folder, "units_row.csv", "Time,Acc 1,Acc 2\n[s],[m/s^2],[g]\n" +
          rows("%.5f", times=seconds))
    write(folder, "blanks.txt", rows("%12.5e", "  ", times=seconds))
    write(folder, "wide.csv", ("t\ta\n" + rows(
        "%.3f", "\t", times=seconds, channels=1)).encode("utf-16"))


# --- AT2 ---------------------------------------------------------------------

def at2_files(folder):
    title = ("PEER NGA STRONG MOTION DATABASE RECORD\nSOMEWHERE, 270\n"
             "ACCELERATION TIME SERIES IN UNITS OF G\n")
    numbers = series(0, N)
    data = "".join("  " + "".join("%15.7E" % value for value in
                                  numbers[i:i + 5]) + "\n"
                   for i in range(0, N, 5))
    write(folder, "new.at2", title + f"NPTS=  {N}, DT=   .0100 SEC,\n" + data)
    write(folder, "old.at2", title + f"   {N}   0.0100   NPTS, DT\n" + data)


# --- Universal files ---------------------------------------------------------

def block(content):
    return b"    -1\n" + content + b"    -1\n"


def function_head(data_type, count, even):
    """Data set 58 down to its numbers: 2 real, 4 double, 5 and 6 complex."""
    kind = 1 if data_type in (2, 4) else 4
    abscissa = 17 if kind == 1 else 18
    return ("acc at 1\nNONE\n01-Mar-24 12:00:00\nNONE\nNONE\n"
            "%5d%10d%5d%10d %-10s%10d%4d %-10s%10d%4d\n" %
            (kind, 0, 0, 0, "NONE", 1, 3, "NONE", 2, -1) +
            "%10d%10d%10d%13.5e%13.5e%13.5e\n" %
            (data_type, count, 1 if even else 0, 0.0, 0.01, 0.0) +
            "%10d%5d%5d%5d %-20s %-20s\n" % (abscissa, 0, 0, 0, "t", "s") +
            "%10d%5d%5d%5d %-20s %-20s\n" % (12, 0, 0, 0, "a", "m/s^2") +
            2 * ("%10d%5d%5d%5d %-20s %-20s\n" % (0, 0, 0, 0, "NONE", "NONE"))
            ).encode()


def text_function(data_type, even=True):
    numbers = []
    for k in range(N):
        if not even:
            numbers.append(0.01 * k)
        numbers.append(y(0, k))
        if data_type in (5, 6):
            numbers.append(y(1, k))
    form, per_line = ("%20.12e", 4) if data_type in (4, 6) else ("%13.5e", 6)
    text = "".join("".join(form % value for value in numbers[i:i + per_line]) +
                   "\n" for i in range(0, len(numbers), per_line))
    return block(b"    58\n" + function_head(data_type, N, even) +
                 text.encode())


def binary_function(data_type, big):
    order = ">" if big else "<"
    numbers = series(0, N)
    data = struct.pack(order + f"{N}{'f' if data_type == 2 else 'd'}",
                       *numbers)
    head = "%6d%1s%6d%6d%12d%12d%6d%6d%12d%12d\n" % (
        58, "b", 2 if big else 1, 2, 11, len(data), 0, 0, 0, 0)
    return block(head.encode() + function_head(data_type, N, True) + data +
                 b"\n")


def shape(is_complex):
    values = [0.1 * k for k in range(12 if is_complex else 6)]
    text = "    55\nmode\nNONE\nNONE\nNONE\nNONE\n"
    text += "%10d%10d%10d%10d%10d%10d\n" % (
        1, 3 if is_complex else 2, 2, 8, 5 if is_complex else 2, 3)
    if is_complex:
        text += "%10d%10d%10d%10d\n" % (2, 6, 0, 1)
        text += "".join("%13.5e" % value
                        for value in (-0.1, 6.0, 1.0, 0.0, 0.0, 0.0)) + "\n"
    else:
        text += "%10d%10d%10d%10d\n" % (2, 4, 0, 1)
        text += "".join("%13.5e" % value
                        for value in (1.5, 1.0, 0.02, 0.0)) + "\n"
    half = len(values) // 2
    for node in (1, 2):
        text += "%10d\n" % node
        text += "".join("%13.5e" % value for value in
                        values[(node - 1) * half:node * half]) + "\n"
    return block(text.encode())


def universal_files(folder):
    nodes = "".join("%10d%10d%10d%10d\n" % (n, 0, 0, 11) +
                    "%25.16E%25.16E%25.16E\n" % (float(n), 0.0, 2.0 * n)
                    for n in (1, 2)).replace("E+", "D+")
    geometry = (
        block(b"   151\nmodel\nNONE\nNONE\nNONE\nNONE\nNONE\nNONE\n") +
        block(b"   164\n%10d%-20s%10d\n" % (1, b"SI", 2) +
              b"  1.0D+00  1.0D+00  1.0D+00\n  2.7315D+02\n") +
        block(b"  2411\n" + nodes.encode()) +
        block(b"    15\n" + b"".join(b"%10d%10d%10d%10d%13.5e%13.5e%13.5e\n" % (
            n, 0, 0, 11, n, 0, 2 * n) for n in (3, 4))) +
        block(b"    82\n%10d%10d%10d\nline\n%10d%10d%10d\n" %
              (1, 3, 1, 1, 2, 0)))
    write(folder, "text.uff", geometry + b"".join(
        text_function(kind) for kind in (2, 4, 5, 6)) +
        text_function(2, even=False))
    write(folder, "binary.uff", binary_function(2, False) +
          binary_function(4, True))
    write(folder, "shapes.unv", shape(False) + shape(True))


def main():
    root = sys.argv[1]
    text_files(os.path.join(root, "text"))
    at2_files(os.path.join(root, "at2"))
    universal_files(os.path.join(root, "universal"))


if __name__ == "__main__":
    main()
