#!/usr/bin/env python3
"""The small TDMS files on which pinode/record/files/loggers/tdms.h is tested,
and from which its fuzzer starts. They are written from the format's published
description, and those of DAQmx from what npTDMS says of them.

Run from the project's root and commit what it writes:

    python3 tests/generators/tdms_files.py tests/fuzz/corpus/tdms

All hold y[c][k] = (c + 1) sin(0.5 k + c), k = 0 to 39 unless a function says
otherwise, at 100 Hz from 2024-03-01 12:00:00.25 UTC, if the format can say so.
"""

import math
import struct
import sys

from logger_files import N, UNIX, series, write, y

INT16, INT32, UINT32, FLOAT, DOUBLE = 2, 3, 7, 9, 10
STRING, TIMESTAMP = 0x20, 0x44
SIZES = {INT16: ("h", 2), INT32: ("i", 4), FLOAT: ("f", 4), DOUBLE: ("d", 8)}
METADATA, NEW_LIST, RAW, INTERLEAVED, BIG, DAQMX = 2, 4, 8, 32, 64, 128


class Time:
    def __init__(self, seconds, fraction):
        self.seconds, self.fraction = seconds, fraction


class Daqmx:
    """Raw data index of DAQmx: `count` rows a chunk, scalers (scale, type,
    buffer, place) and the widths of the buffers. The place is in bytes, of
    digital lines in bits."""

    def __init__(self, count, scalers, widths, digital=False):
        self.count, self.scalers, self.widths = count, scalers, widths
        self.digital = digital

    def packed(self, f):
        data = f.pack("IIIQI", 0x126A if self.digital else 0x1269, 0xFFFFFFFF,
                      1, self.count, len(self.scalers))
        for scale, kind, buffer, place in self.scalers:
            data += f.pack("IIIBI" if self.digital else "IIIII", kind, buffer,
                           place, 0, scale)
        return data + f.pack(f"I{len(self.widths)}I", len(self.widths),
                             *self.widths)


class Tdms:
    """Packs segments. Index: (type, count), "same", or None without data."""

    def __init__(self, big=False):
        self.big = big
        self.bytes = b""

    def pack(self, form, *values):
        return struct.pack((">" if self.big else "<") + form, *values)

    def string(self, text):
        data = text.encode("utf-8")
        return self.pack("I", len(data)) + data

    def time(self, seconds, fraction):
        # 1904 to 1970.
        whole, part = seconds + 2082844800, int(fraction * 2**64)
        return (self.pack("qQ", whole, part) if self.big
                else self.pack("Qq", part, whole))

    def property(self, name, value):
        head = self.string(name)
        if isinstance(value, str):
            return head + self.pack("I", STRING) + self.string(value)
        if isinstance(value, Time):
            return (head + self.pack("I", TIMESTAMP) +
                    self.time(value.seconds, value.fraction))
        if isinstance(value, int):
            return head + self.pack("II", UINT32, value)
        return head + self.pack("Id", DOUBLE, value)

    def object(self, path, index=None, properties=()):
        data = self.string(path)
        if index is None:
            data += self.pack("I", 0xFFFFFFFF)
        elif index == "same":
            data += self.pack("I", 0)
        elif isinstance(index, Daqmx):
            data += index.packed(self)
        elif index[0] == STRING:
            data += self.pack("IIIQQ", 28, STRING, 1, index[1], index[2])
        else:
            data += self.pack("IIIQ", 20, index[0], 1, index[1])
        data += self.pack("I", len(properties))
        for name, value in properties:
            data += self.property(name, value)
        return data

    def segment(self, flags, objects=(), raw=b"", unfinished=False):
        if self.big:
            flags |= BIG
        metadata = b""
        if flags & METADATA:
            metadata = self.pack("I", len(objects)) + b"".join(objects)
        size = len(metadata) + len(raw)
        self.bytes += b"TDSm" + struct.pack("<I", flags) + self.pack(
            "IQQ", 4713, 2**64 - 1 if unfinished else size, len(metadata))
        self.bytes += metadata + raw

    def numbers(self, kind, values):
        return self.pack(f"{len(values)}{SIZES[kind][0]}", *values)


def wave(step=0.01, unit="m/s^2", offset=0.0, start=True, fraction=0.25):
    properties = [("wf_increment", step), ("wf_start_offset", offset),
                  ("wf_samples", 1), ("unit_string", unit)]
    if start:
        properties.append(("wf_start_time", Time(UNIX, fraction)))
    return properties


def tdms_basic():
    """Two channels in chunks of 5, two chunks a segment; the second segment
    without metadata, the third with new values of one property."""
    f = Tdms()
    raw = [b"".join(f.numbers(DOUBLE, series(0, 5, first)) +
                    f.numbers(FLOAT, series(1, 5, first))
                    for first in (begin, begin + 5))
           for begin in (0, 10, 20, 30)]
    f.segment(METADATA | NEW_LIST | RAW, [
        f.object("/", None, [("name", "Messung Brücke")]),
        f.object("/'acc'"),
        f.object("/'acc'/'a1'", (DOUBLE, 5), wave()),
        f.object("/'acc'/'it''s a2'", (FLOAT, 5), wave(unit="mg"))], raw[0])
    f.segment(RAW, (), raw[1])
    f.segment(METADATA | RAW, [f.object("/'acc'/'a1'", "same",
                                        [("note", "x")])], raw[2])
    f.segment(RAW, (), raw[3])
    return f.bytes


def tdms_interleaved():
    f = Tdms(big=True)
    rows = b"".join(f.numbers(FLOAT, [y(0, k)]) + f.numbers(INT32, [k]) +
                    f.numbers(DOUBLE, [y(2, k)]) for k in range(N))
    f.segment(METADATA | NEW_LIST | RAW | INTERLEAVED, [
        f.object("/'g'/'a'", (FLOAT, N // 2), wave()),
        f.object("/'g'/'count'", (INT32, N // 2), wave(unit="")),
        f.object("/'g'/'b'", (DOUBLE, N // 2), wave(unit="g"))], rows)
    return f.bytes


def tdms_lists():
    """Channels that come and go: a and b; b alone; a new list of b and c."""
    f = Tdms()
    f.segment(METADATA | NEW_LIST | RAW, [
        f.object("/'g'/'a'", (DOUBLE, 10), wave()),
        f.object("/'g'/'b'", (DOUBLE, 10), wave())],
        f.numbers(DOUBLE, series(0, 10)) + f.numbers(DOUBLE, series(1, 10)))
    f.segment(METADATA | RAW, [f.object("/'g'/'a'")],
              f.numbers(DOUBLE, series(1, 10, 10)))
    f.segment(METADATA | NEW_LIST | RAW, [
        f.object("/'g'/'c'", (DOUBLE, 20), wave()),
        f.object("/'g'/'b'", (DOUBLE, 20))],
        f.numbers(DOUBLE, series(2, 20)) + f.numbers(DOUBLE, series(1, 20, 20)))
    return f.bytes


def tdms_scaled():
    """raw = round(1000 y) and counts = raw / 2 in volts, 10 y = 0.02 counts."""
    f = Tdms()
    raw = [round(1000 * value) for value in series(0)]
    linear = [("NI_Scaling_Status", "unscaled"), ("NI_Number_Of_Scales", 2),
              ("NI_Scale[0]_Scale_Type", "Linear"),
              ("NI_Scale[0]_Linear_Slope", 0.5),
              ("NI_Scale[0]_Linear_Y_Intercept", 3.0),
              ("NI_Scale[0]_Linear_Input_Source", 0xFFFFFFFF),
              ("NI_Scale[1]_Scale_Type", "Polynomial"),
              ("NI_Scale[1]_Polynomial_Coefficients_Size", 3),
              ("NI_Scale[1]_Polynomial_Coefficients[0]", 1.0),
              ("NI_Scale[1]_Polynomial_Coefficients[1]", 0.02),
              ("NI_Scale[1]_Polynomial_Coefficients[2]", 1e-6),
              ("NI_Scale[1]_Polynomial_Input_Source", 0)]
    other = [("NI_Scaling_Status", "unscaled"), ("NI_Number_Of_Scales", 1),
             ("NI_Scale[0]_Scale_Type", "RTD")]
    f.segment(METADATA | NEW_LIST | RAW, [
        f.object("/'g'/'a'", (INT16, N), wave() + linear),
        f.object("/'g'/'b'", (INT16, N), wave() + other)],
        2 * f.numbers(INT16, raw))
    return f.bytes


def tdms_rates():
    """a at 100 Hz from 0.25 s; b at 200 Hz from 0.27 s; T at 5 Hz from 0.27 s;
    late at 100 Hz from 0.253 s, between the samples of a."""
    f = Tdms()
    # Slow enough for the lowest rate: 2 sin(2 pi 3 t) of time t from 0.25 s.
    b = [2 * math.sin(2 * math.pi * 3 * (0.02 + 0.005 * k)) for k in range(800)]
    a = [math.sin(2 * math.pi * 3 * 0.01 * k) for k in range(400)]
    temperature = [20.0 + k for k in range(20)]
    f.segment(METADATA | NEW_LIST | RAW, [
        f.object("/'g'/'a'", (FLOAT, 400), wave()),
        f.object("/'g'/'b'", (FLOAT, 800), wave(step=0.005, fraction=0.27)),
        f.object("/'g'/'T'", (FLOAT, 20), wave(step=0.2, unit="degC",
                                               fraction=0.27)),
        f.object("/'g'/'late'", (FLOAT, 40), wave(fraction=0.253)),
        f.object("/'g'/'undated'", (FLOAT, 40), wave(start=False)),
        f.object("/'g'/'stepless'", (FLOAT, 40))],
        f.numbers(FLOAT, a) + f.numbers(FLOAT, b) +
        f.numbers(FLOAT, temperature) + 3 * f.numbers(FLOAT, series(0)))
    return f.bytes


def tdms_columns():
    """Channels without a clock of their own, a channel of clock times, text."""
    f = Tdms()
    times = b"".join(f.time(UNIX, 0.25 + 0.01 * k) for k in range(N))
    text = f.pack("5I", 1, 2, 3, 4, 5) + b"abcde"
    f.segment(METADATA | NEW_LIST | RAW, [
        f.object("/'g'/'Time'", (TIMESTAMP, N)),
        f.object("/'g'/'a'", (DOUBLE, N), [("unit_string", "g")]),
        f.object("/'g'/'note'", (STRING, 5, len(text)))],
        times + f.numbers(DOUBLE, series(0)) + text)
    return f.bytes


def tdms_unfinished():
    f = Tdms()
    f.segment(METADATA | NEW_LIST | RAW,
              [f.object("/'g'/'a'", (DOUBLE, 10), wave()),
               f.object("/'g'/'b'", (DOUBLE, 10), wave())],
              b"".join(f.numbers(DOUBLE, series(c, 10, first))
                       for first in (0, 10, 20) for c in (0, 1)) +
              f.numbers(DOUBLE, series(0, 10, 30)) +
              f.numbers(DOUBLE, series(1, 4, 30)) + b"\0\0\0",
              unfinished=True)
    return f.bytes


# Types of DAQmx, by their codes, with their form and factor of y.
DAQMX_U8, DAQMX_I8, DAQMX_U16, DAQMX_I16, DAQMX_U32, DAQMX_I32 = range(6)
FORMS = {DAQMX_U8: "B", DAQMX_I8: "b", DAQMX_U16: "H", DAQMX_I16: "h",
         DAQMX_U32: "I", DAQMX_I32: "i"}


def linear(number, slope, intercept, source):
    start = f"NI_Scale[{number}]_"
    return [(start + "Scale_Type", "Linear"),
            (start + "Linear_Slope", slope),
            (start + "Linear_Y_Intercept", intercept),
            (start + "Linear_Input_Source", source)]


def scales(count, *lists):
    return ([("NI_Scaling_Status", "unscaled"),
             ("NI_Number_Of_Scales", count)] + [p for one in lists for p in one])


def daqmx_rows(f, kinds, rows):
    """Rows of a buffer: kinds are types, rows lists of their counts."""
    return b"".join(f.pack(FORMS[kind], n) for row in rows
                    for kind, n in zip(kinds, row))


def tdms_daqmx(big=False):
    """Two cards of two channels each, in two chunks of 20 and 10 rows, and two
    more without metadata. a: 16 bit, y = 2^-10 counts; b: 32 bit, y = 2^-20
    (counts - 7); c: unsigned 16 bit at 50 Hz, y of every other k by a table
    between 0 and 65535; counts: 8 bit, without a scale."""
    f = Tdms(big)
    raw = []
    for begin in (0, 20):
        ks = range(begin, begin + 20)
        first = daqmx_rows(f, (DAQMX_I16, DAQMX_I32), [
            (round(1024 * y(0, k)), round(2**20 * y(1, k)) + 7) for k in ks])
        second = daqmx_rows(f, (DAQMX_I8, DAQMX_U16), [
            (k - 20, round(65535 * (y(2, k) + 4) / 8)) for k in ks[::2]])
        raw.append(first + second)
    widths = (6, 3)
    table = [("NI_Scale[1]_Scale_Type", "Table"),
             ("NI_Scale[1]_Table_Input_Source", 0)]
    for name, values in [("Scaled", (65535.0, 16383.75, 0.0)),
                         ("Pre_Scaled", (4.0, -2.0, -4.0))]:
        start = f"NI_Scale[1]_Table_{name}_Values"
        table.append((start + "_Size", 3))
        table += [(f"{start}[{i}]", v) for i, v in enumerate(values)]
    f.segment(METADATA | NEW_LIST | RAW | DAQMX, [
        f.object("/"), f.object("/'g'"),
        f.object("/'g'/'a'", Daqmx(20, [(0, DAQMX_I16, 0, 0)], widths),
                 wave() + scales(2, linear(1, 2.0**-10, 0.0, 0))),
        f.object("/'g'/'b'", Daqmx(20, [(0, DAQMX_I32, 0, 2)], widths),
                 wave() + scales(3, linear(1, 1.0, -7.0, 0),
                                 linear(2, 2.0**-20, 0.0, 1))),
        f.object("/'g'/'counts'", Daqmx(10, [(0, DAQMX_I8, 1, 0)], widths),
                 wave(step=0.02, unit="")),
        f.object("/'g'/'c'", Daqmx(10, [(0, DAQMX_U16, 1, 1)], widths),
                 wave(step=0.02) + scales(2, table))],
        raw[0])
    f.segment(RAW | DAQMX, (), raw[1])
    return f.bytes


def tdms_daqmx_scalers():
    """One channel of two series of counts: y = 2^-4 coarse + 2^-12 fine, by a
    sum; `less` the same two by a difference, right minus left."""
    f = Tdms()
    rows = []
    for k in range(N):
        counts = round(2**12 * y(0, k))
        coarse = counts // 256
        rows.append((coarse, counts - 256 * coarse))
    place = Daqmx(N, [(0, DAQMX_I16, 0, 0), (1, DAQMX_U8, 0, 2)], (3,))

    def both(kind):
        start = f"NI_Scale[4]_{kind}_"
        return scales(5, linear(2, 2.0**-4, 0.0, 0), linear(3, 2.0**-12, 0.0, 1),
                      [("NI_Scale[4]_Scale_Type", kind),
                       (start + "Left_Operand_Input_Source", 2),
                       (start + "Right_Operand_Input_Source", 3)])
    f.segment(METADATA | NEW_LIST | RAW | DAQMX, [
        f.object("/'g'/'y'", place, wave() + both("Add")),
        f.object("/'g'/'less'", place, wave() + both("Subtract")),
        f.object("/'g'/'bare'", place, wave())],
        daqmx_rows(f, (DAQMX_I16, DAQMX_U8), rows))
    return f.bytes


def tdms_daqmx_digital():
    """Lines 1, 3 and 10 of a port of 32: bits of k, of k / 2 and of k / 4. The
    segment was not finished, and ends inside a row."""
    f = Tdms()
    rows = [((k & 1) << 1 | (k >> 1 & 1) << 3 | (k >> 2 & 1) << 10 | 1 << 9,)
            for k in range(N)]
    f.segment(METADATA | NEW_LIST | RAW | DAQMX, [
        f.object(f"/'g'/'line{bit}'",
                 Daqmx(N, [(0, DAQMX_U32, 0, bit)], (4,), digital=True),
                 wave(unit="")) for bit in (1, 3, 10)],
        daqmx_rows(f, (DAQMX_U32,), rows)[:-5], unfinished=True)
    return f.bytes


def main():
    folder = sys.argv[1]
    for name, content in [
            ("basic", tdms_basic()), ("interleaved", tdms_interleaved()),
            ("lists", tdms_lists()), ("scaled", tdms_scaled()),
            ("columns", tdms_columns()), ("unfinished", tdms_unfinished()),
            ("rates", tdms_rates()), ("daqmx", tdms_daqmx()),
            ("daqmx_big", tdms_daqmx(big=True)),
            ("daqmx_scalers", tdms_daqmx_scalers()),
            ("daqmx_digital", tdms_daqmx_digital())]:
        write(folder, name + ".tdms", content)


if __name__ == "__main__":
    main()
