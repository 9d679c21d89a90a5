#!/usr/bin/env python3
"""The small files of data loggers on which the readers of
pinode/record/files/loggers are tested, and from which their fuzzers start.
They are written from the formats' published descriptions, with nothing of the
readers.

Run from the project's root and commit what it writes:

    python3 tests/generators/logger_files.py tests/fuzz/corpus

All hold y[c][k] = (c + 1) sin(0.5 k + c), k = 0 to 39 unless a function says
otherwise, at 100 Hz from 2024-03-01 12:00:00.25 UTC, if the format can say so.
"""

import math
import os
import struct
import sys

N = 40
RATE = 100.0
UNIX = 1709294400  # 2024-03-01 12:00:00 UTC


def y(c, k):
    return (c + 1) * math.sin(0.5 * k + c)


def series(c, count=N, first=0):
    return [y(c, first + k) for k in range(count)]


def write(folder, name, content):
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, name), "wb") as file:
        file.write(content if isinstance(content, bytes)
                   else content.encode("utf-8"))


# --- K-NET and KiK-net -------------------------------------------------------

def knet(direction, scale, c):
    """Whole numbers near y / scale, with an offset of 1000 counts."""
    header = [
        ("Origin Time", "2024/03/01 20:59:12"), ("Lat.", "37.500"),
        ("Long.", "137.200"), ("Depth. (km)", "16"), ("Mag.", "5.1"),
        ("Station Code", "ISK003"), ("Station Lat.", "37.3906"),
        ("Station Long.", "136.9031"), ("Station Height(m)", "60"),
        ("Record Time", "2024/03/01 21:00:15"),
        ("Sampling Freq(Hz)", "100Hz"), ("Duration Time(s)", "0.4"),
        ("Dir.", direction), ("Scale Factor", scale),
        ("Max. Acc. (gal)", "2.0"), ("Last Correction", "2024/03/01 21:00:00"),
        ("Memo.", "")]
    text = "".join(f"{label:<18}{value}".rstrip() + "\n"
                   for label, value in header)
    full, counts = scale.split("/")
    factor = float(full.split("(")[0]) / float(counts)
    numbers = [1000 + round(value / factor) for value in series(c)]
    for i in range(0, N, 8):
        text += " ".join(f"{n:8d}" for n in numbers[i:i + 8]) + " \n"
    return text


def knet_files(folder):
    write(folder, "knet.EW", knet("E-W", "3920(gal)/6182761", 0))
    write(folder, "kiknet.UD2", knet("6", "2940(gal)/8388608", 1))


# --- CSMIP and COSMOS --------------------------------------------------------

def fixed(numbers, per_line, form):
    text = ""
    for i in range(0, len(numbers), per_line):
        line = ""
        for value in numbers[i:i + per_line]:
            cell = form % value
            # Fortran leaves out the zero before the point.
            cell = cell.replace(" 0.", "  .").replace("-0.", " -.")
            line += cell[-10:] if len(cell) > 10 else cell
        text += line + "\n"
    return text


def csmip_channel(number, azimuth):
    c = number - 1
    text = (f"Corrected accelerogram   89146-L2500-12044.02       "
            f"Chan {number:2d}: {azimuth} Deg     from   \n"
            "Uncorrected Accelerogram Data             Processed: 03/02/24\n"
            "Record of Fri Mar  1, 2024 04:00:00.2 PST\n"
            "CSMIP Preliminary Processing\n"
            "89146-L2500-12044.02                 "
            "Start time:  3/1/24, 12:00:00.25 UTC (GPS)\n"
            "Station No. 89146   40.941N, 123.633W      Etna\n"
            "Somewhere                                 CGS\n"
            f"Chan {number:2d}: {azimuth} Deg\n")
    text += "\n" * 7
    text += (f"    {N} points of instrument- and baseline-corrected accel, "
             "veloc and displ data\n"
             "At equally-spaced intervals of    .010  sec.\n")
    text += "\n" * 8
    text += "".join("%5d" * 16 % tuple(range(16)) + "\n" for _ in range(6))
    text += "%5d" * 4 % (1, 2, 3, 4) + "\n"
    text += fixed([0.01 * i for i in range(100)], 8, "%10.5f")
    # 100 times y, so that the negative numbers touch: -100.12345.
    for factor, word, unit in [(100, "accel", "cm/sec2"),
                               (10, "veloc", "cm/sec"), (1, "displ", "cm")]:
        text += (f"    {N} points of {word} data equally spaced at  .010 sec,"
                 f" in {unit}. (8f10.5)\n")
        text += fixed([factor * value for value in series(c)], 8, "%10.5f")
    return text + f"/&  ----------  End of data for channel {number:2d}  ----\n"


def csmip_raw_channel(number, azimuth):
    """Volume 1: g, in fields of nine, 1000 gal being enough to touch."""
    c = number - 1
    text = ("Uncorrected Accelerogram Data             Processed: 03/02/24, CGS\n"
            "Record of Fri Mar  1, 2024 04:00:00.2 PST             (Avol1)\n"
            "CSMIP Preliminary Processing            (Origin:  To be determined)\n"
            "89146-L2500-12044.02                 "
            "Start time:  3/1/24, 12:00:00.25 UTC (GPS)\n"
            "Station No. 89146   40.941N, 123.633W      Etna\n"
            "Somewhere                                 CGS\n"
            f"Chan {number:2d}: {azimuth} Deg\n" + "\n" * 3 +
            f"No. of Points =  {N}  Record Length =   .400 sec   at 100 "
            "Samples/sec\nUnits of uncor data are sec and g .\n\n")
    text += "".join("%5d" * 16 % tuple(range(16)) + "\n" for _ in range(6))
    text += "%5d" * 4 % (1, 2, 3, 4) + "\n"
    text += fixed([0.01 * i for i in range(50)], 8, "%10.6f")
    text += (f" {N:5d} Accelerogram points at 100 pts/sec in units of g"
             f"{' .' if number == 1 else '. '}      Format: (8f9.6)\n")
    for i in range(0, N, 8):
        # Fortran leaves out the zero before the point.
        text += "".join(("%9.6f" % value).replace(" 0.", "  .").replace(
            "-0.", " -.") for value in series(c)[i:i + 8]) + "\n"
    return text + f"/&  ----------  End of data for channel {number:2d}  ----\n"


def csmip_film():
    """Volume 1 of a film recorder: pairs of time and g/10."""
    text = ("UNCORRECTED ACCELEROGRAM DATA              PROCESSED: 02/08/94\n"
            "SOME EARTHQUAKE\n"
            "14403-S3492-94021.02               TRIGGER TIME: 01/17/94, "
            "12:31:04.1 UTC\nCHAN  1:  90 DEG\n"
            f"NO. OF POINTS =  {N}  RECORD LENGTH =  .390 SEC\n"
            "UNITS OF UNCOR ACCEL ARE SEC AND G/10.\n")
    for i in range(0, N, 5):
        text += "".join("%7.3f%7.3f" % (0.0101 * k, y(0, k))
                        for k in range(i, i + 5)) + "\n"
    return text


def cosmos_section(number, kind, word, unit, factor):
    c = number - 1
    text = (f"Corrected {kind}    (Format v01.20 with 13 text lines)\n"
            "Some earthquake of Friday 1 March 2024\n"
            "Hypocenter: 40.350   -124.899   H= 20km M=4.8\n"
            "Origin: 03/01/2024, 11:59:30.0 UTC\n"
            "Statn No: 05-    0  Code:CE-79435  CGS  Somewhere\n"
            "Coords: 39.9233 -123.7614  Site geology:Unknown\n"
            "Recorder:        s/n:     (  3 Chns of  3 at Sta)\n"
            "Rcrd start time:03/01/2024, 12:00:00.250 UTC (Q= ) RcrdId:X\n"
            f"Sta Chan {number:3d}:270 deg (Rcrdr Chan  1) Location:10\n"
            "Raw record length =   0.400 sec, Uncor max =    0.000\n"
            "Processed:                               Max =    -0.588\n"
            "Record filtered below  0.66 Hz\n"
            "Values used when parameter or data value is unknown:   -999 -999.0"
            "\n"
            " 100  Integer-header values follow on 10 lines, Format= (10I8)\n")
    text += "".join("%8d" * 10 % tuple([-999] * 10) + "\n" for _ in range(10))
    real = [-999.0] * 100
    real[33] = 0.005  # of the raw record
    real[61] = 10.0   # ms, of this one
    text += "100 Real-header values follow on 17 lines , Format = (6F13.6)\n"
    for i in range(0, 100, 6):
        text += "".join("%13.6f" % value for value in real[i:i + 6]) + "\n"
    text += ("   2 Comment line(s) follow, each starting with a \"|\":\n"
             "| Sensor: none\n| 40 points of nothing\n"
             f"      {N} {word} pts, approx  0 secs, units={unit},"
             "Format=(8f10.5)\n")
    text += fixed([factor * value for value in series(c)], 8, "%10.5f")
    return text + f"End-of-data for Chan  {number} {kind}\n"


def strong_motion_files(folder):
    write(folder, "csmip.v2", csmip_channel(1, 360) + csmip_channel(2, 90))
    write(folder, "csmip.v1",
          csmip_raw_channel(1, 360) + csmip_raw_channel(2, 90))
    write(folder, "film.raw", csmip_film())
    # Another centre writes the channel in another way.
    write(folder, "cosmos.v1", "".join(
        cosmos_section(number, "acceleration", "acceleration", "cm/sec2(04)",
                       100).replace(f"Sta Chan {number:3d}:270 deg",
                                    f"Sta Cha: {number:2d}: 270 deg")
        for number in (2, 3)))
    write(folder, "cosmos.v2c",
          cosmos_section(1, "acceleration", "acceleration", "cm/sec^2(04)",
                         100) +
          cosmos_section(1, "velocity", "velocity", "cm/sec  (05)", 10) +
          cosmos_section(3, "acceleration", "acceleration", "cm/sec^2(04)",
                         100))


# --- miniSEED ----------------------------------------------------------------

def steim_frames(words_of, values):
    """Packs differences into frames of 16 words: words_of(differences) yields
    (nibble, word). The first frame holds the first and last value."""
    differences = [0] + [b - a for a, b in zip(values, values[1:])]
    words = list(words_of(differences))
    frames = b""
    first = True
    while words or first:
        room = 13 if first else 15
        taken, words = words[:room], words[room:]
        head = [(0, values[0] & 0xFFFFFFFF), (0, values[-1] & 0xFFFFFFFF)]
        taken = (head if first else []) + taken
        taken += [(0, 0)] * (15 - len(taken))
        control = 0
        for i, (nibble, _) in enumerate(taken):
            control |= nibble << (28 - 2 * i)
        frames += struct.pack(">16I", control, *[word for _, word in taken])
        first = False
    return frames


def packed(differences, bits):
    word = 0
    for value in differences:
        word = (word << bits) | (value & ((1 << bits) - 1))
    return word


def fits(differences, bits):
    return all(-(1 << (bits - 1)) <= v < (1 << (bits - 1))
               for v in differences)


def steim1(differences):
    at = 0
    while at < len(differences):
        for count, bits, nibble in [(4, 8, 1), (2, 16, 2), (1, 32, 3)]:
            part = differences[at:at + count]
            if len(part) == count and fits(part, bits):
                yield nibble, packed(part, bits)
                at += count
                break


def steim2(differences):
    at = 0
    forms = [(7, 4, 3, 2), (6, 5, 3, 1), (5, 6, 3, 0), (4, 8, 1, None),
             (3, 10, 2, 3), (2, 15, 2, 2), (1, 30, 2, 1)]
    while at < len(differences):
        for count, bits, nibble, code in forms:
            part = differences[at:at + count]
            if len(part) == count and fits(part, bits):
                word = packed(part, bits)
                yield nibble, word | ((code or 0) << 30)
                at += count
                break


def mseed_record(channel, values, encoding, ticks, number=1):
    """One record of 512 bytes from UNIX + ticks / 10000 s; encoding 3 int32,
    4 float, 5 double, 10 Steim1, 11 Steim2."""
    data = {3: lambda: struct.pack(f">{len(values)}i", *values),
            4: lambda: struct.pack(f">{len(values)}f", *values),
            5: lambda: struct.pack(f">{len(values)}d", *values),
            10: lambda: steim_frames(steim1, values),
            11: lambda: steim_frames(steim2, values)}[encoding]()
    seconds, fraction = divmod(ticks, 10000)
    header = f"{number:06d}D STA  00{channel}XX".encode()
    header += struct.pack(">HHBBBBH", 2024, 61, 12, 0, seconds, 0, fraction)
    header += struct.pack(">HhhBBBBiHH", len(values), 100, 1, 0, 0, 0, 1, 0,
                          64, 48)
    header += struct.pack(">HHBBBB", 1000, 0, encoding, 1, 9, 0)
    record = header.ljust(64, b"\0") + data
    assert len(record) <= 512
    return record.ljust(512, b"\0")


def checksum(data):
    """CRC-32C, bit by bit."""
    value = 0xFFFFFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value >> 1) ^ (0x82F63B78 if value & 1 else 0)
    return value ^ 0xFFFFFFFF


def mseed3_record(source, values, encoding, nanoseconds, rate=100.0,
                  extra=b""):
    """A record of version 3 from UNIX + nanoseconds; encodings as above, and 0
    text, 1 int16. A negative rate is the step."""
    data = {0: lambda: values.encode(),
            1: lambda: struct.pack(f"<{len(values)}h", *values),
            3: lambda: struct.pack(f"<{len(values)}i", *values),
            4: lambda: struct.pack(f"<{len(values)}f", *values),
            5: lambda: struct.pack(f"<{len(values)}d", *values),
            10: lambda: steim_frames(steim1, values),
            11: lambda: steim_frames(steim2, values)}[encoding]()
    seconds, rest = divmod(nanoseconds, 10**9)
    head = b"MS\x03\x00" + struct.pack("<IHHBBBBdI", rest, 2024, 61, 12, 0,
                                       seconds, encoding, rate, len(values))
    tail = struct.pack("<BBHI", 1, len(source), len(extra), len(data))
    tail += source.encode() + extra + data
    return head + struct.pack(
        "<I", checksum(head + b"\0\0\0\0" + tail)) + tail


def mseed3_files(folder):
    z, e = "FDSN:XX_STA_00_H_N_Z", "FDSN:XX_STA_00_H_N_E"
    note = b'{"FDSN":{"Time":{"Quality":100}}}'
    write(folder, "three.mseed",
          mseed3_record(z, counts(0, 20), 10, 250000000, extra=note) +
          mseed3_record(e, counts(1, 20), 11, 250000000) +
          mseed3_record(z, counts(0, 20, 20), 10, 450000000) +
          mseed3_record(e, counts(1, 20, 20), 11, 450000000, extra=note))
    small = [round(1000 * value) for value in series(0)]
    write(folder, "three_numbers.mseed",
          mseed3_record("FDSN:XX_STA__H_N_1", small, 1, 250000000) +
          mseed3_record("FDSN:XX_STA__H_N_2", counts(1), 3, 250000000, -0.01) +
          mseed3_record("mast/top", series(1), 4, 250000000) +
          mseed3_record(z, series(2, 10), 5, 250000000) +
          mseed3_record(z, series(2, 25, 15), 5, 400000000) +
          mseed3_record("FDSN:XX_STA__L_O_G", "a note", 0, 0, 0.0))


def counts(c, count=N, first=0):
    """With steps from small to more than 16 bits."""
    return [round((1, 1000, 100000)[(first + k) // 14 % 3] * y(c, first + k))
            for k in range(count)]


def mseed_files(folder):
    write(folder, "steim.mseed",
          mseed_record("HNZ", counts(0, 20), 10, 2500, 1) +
          mseed_record("HNE", counts(1, 20), 11, 2500, 2) +
          mseed_record("HNZ", counts(0, 20, 20), 10, 4500, 3) +
          mseed_record("HNE", counts(1, 20, 20), 11, 4500, 4))
    write(folder, "numbers.mseed",
          mseed_record("HNZ", counts(0), 3, 2500) +
          mseed_record("HNN", series(1), 4, 2500) +
          mseed_record("HNE", series(2), 5, 2500))
    # Samples 10 to 14 are missing; the later record comes first.
    write(folder, "gap.mseed",
          mseed_record("HNZ", series(0, 25, 15), 4, 4000) +
          mseed_record("HNZ", series(0, 10), 4, 2500))
    write(folder, "overlap.mseed",
          mseed_record("HNZ", series(0, 20), 4, 2500) +
          mseed_record("HNZ", series(0, 20), 4, 3500))


# --- SAC ---------------------------------------------------------------------

def sac(order, version=6, leven=1, count=N, delta=0.01):
    floats = [-12345.0] * 70
    floats[0], floats[5], floats[6] = delta, 0.05, 0.05 + 0.01 * (N - 1)
    integers = [-12345] * 40
    integers[0:6] = [2024, 61, 12, 0, 0, 200]
    integers[6], integers[9], integers[15] = version, count, 1
    integers[35] = leven
    texts = [b"-12345".ljust(8)] * 24
    texts[0] = b"STA".ljust(8)
    texts[20] = b"HNZ".ljust(8)  # KCMPNM; KEVNM takes two of the eight bytes
    content = struct.pack(order + "70f40i", *floats, *integers)
    content += b"".join(texts)
    content += struct.pack(f"{order}{N}f", *series(0))
    if version == 7:
        content += struct.pack(order + "22d", delta, 0.05, *([-12345.0] * 20))
    return content


def sac_files(folder):
    write(folder, "little.sac", sac("<"))
    write(folder, "big.sac", sac(">"))
    write(folder, "double.sac", sac("<", version=7))
    write(folder, "short.sac", sac("<", count=N + 1))
    write(folder, "uneven.sac", sac("<", leven=0))


# --- LVM ---------------------------------------------------------------------

def lvm_header(separator, decimal, columns, multi="No"):
    lines = ["LabVIEW Measurement" + separator,
             "Writer_Version{s}2", "Reader_Version{s}2", "Separator{s}" +
             ("Tab" if separator == "\t" else "Comma"),
             "Decimal_Separator{s}" + decimal, "Multi_Headings{s}" + multi,
             "X_Columns{s}" + columns, "Time_Pref{s}Absolute",
             "Operator{s}me", "Date{s}2024/03/01",
             "Time{s}12:00:00{d}25", "***End_of_Header***{s}", ""]
    return "".join(line.replace("{s}", separator).replace("{d}", decimal) +
                   "\r\n" for line in lines)


def lvm_segment(separator, decimal, columns, first=0, count=N, x0=0.0,
                seconds=0.25, comment=True):
    def number(value):
        return ("%.6f" % value).replace(".", decimal)

    def row(label, cells):
        between = [separator, separator * 2][columns == "Multi"]
        return label + separator + between.join(cells) + separator + "\r\n"

    clock = number(seconds).rjust(9, "0")
    text = f"Channels{separator}2\r\n"
    text += row("Samples", [str(count)] * 2)
    text += row("Date", ["2024/03/01"] * 2)
    text += row("Time", ["12:00:" + clock] * 2)
    text += row("Y_Unit_Label", ["m/s^2", "mg"])
    text += row("X_Dimension", ["Time"] * 2)
    text += row("X0", [number(x0)] * 2)
    text += row("Delta_X", [number(0.01)] * 2)
    text += f"***End_of_Header***{separator}{separator}\r\n"
    x_name = "X_Value"
    names = ([x_name, "a1", x_name, "a2"] if columns == "Multi"
             else [x_name, "a1", "a2"])
    text += separator.join(names + ["Comment"] * comment) + "\r\n"
    for k in range(first, first + count):
        x = number(x0 + 0.01 * (k - first))
        a, b = number(y(0, k)), number(y(1, k))
        cells = {"One": [x, a, b], "Multi": [x, a, x, b],
                 "No": ["", a, b]}[columns]
        text += separator.join(cells) + "\r\n"
    return text


def lvm_files(folder):
    for columns in ("One", "Multi", "No"):
        write(folder, columns.lower() + ".lvm",
              lvm_header("\t", ".", columns) +
              lvm_segment("\t", ".", columns))
    write(folder, "decimal_comma.lvm",
          lvm_header("\t", ",", "One") + lvm_segment("\t", ",", "One"))
    write(folder, "comma.lvm",
          lvm_header(",", ".", "One") + lvm_segment(",", ".", "One"))
    # A card samples the second channel 14 us after the first; a note behind the
    # first row.
    skew = lvm_segment("\t", ".", "One").replace(
        "\t12:00:00.250000\t\r\n", "\t12:00:00.250014\t\r\n")
    skew = skew.replace("\t1.682942\r\n", "\t1.682942\tStandby\r\n", 1)
    assert "250014" in skew and "Standby" in skew
    write(folder, "skew.lvm", lvm_header("\t", ".", "One") + skew)
    # The second segment goes on by X0; the third by its time, after 5 samples
    # that are missing.
    write(folder, "segments.lvm",
          lvm_header("\t", ".", "One", "Yes") +
          lvm_segment("\t", ".", "One", 0, 10) + "\r\n" +
          lvm_segment("\t", ".", "One", 10, 10, 0.10) + "\r\n" +
          lvm_segment("\t", ".", "One", 25, 15, 0.0, 0.50))
    write(folder, "jump.lvm",
          lvm_header("\t", ".", "One", "Yes") +
          lvm_segment("\t", ".", "One", 0, 10) + "\r\n" +
          lvm_segment("\t", ".", "One", 10, 10, 0.0, 0.354))


def main():
    root = sys.argv[1]
    knet_files(os.path.join(root, "knet"))
    strong_motion_files(os.path.join(root, "strong_motion"))
    mseed_files(os.path.join(root, "mini_seed"))
    mseed3_files(os.path.join(root, "mini_seed"))
    sac_files(os.path.join(root, "sac"))
    lvm_files(os.path.join(root, "lvm"))


if __name__ == "__main__":
    main()
