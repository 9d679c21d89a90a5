#!/usr/bin/env python3
"""False alarms and detections of pinode_watch over simulated years.

    tests/benchmarks/watch.py [--program P] [--runs 8] [--step_hours 1] [--scatter 0.001]
                              [--noise 0.002] [--loss 0.02] [--group 0] [--years 3]
                              [--growth_days 0] [--colder 0] [--missing 0.05] [--within 7]

The structure is data/watched_bridge.  Its frequencies, not its records, go into
a store, from which the program computes histories, chart and alarms.  Year 1 is the
reference; years 2 and 3 are counted.  Frequencies have the stated scatter (a
law that the regression lacks, memory 1 day) and the noise of their estimates,
and --missing of them are absent.

Without --loss every alarm is false.  With it, the loss of --group begins after
--loss_day, and a detection is an alarm within --within days of it (7) that is not
one from before.  --growth_days: the loss grows over this time, and counts until its
end.  --colder: the last winter is colder by so many degrees.
"""

import argparse
import json
import pathlib
import sqlite3
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "data" / "watched_bridge"))
import generate  # noqa: E402

EPOCH = 1704067200  # 2024-01-01
COLD_DAY = 1022  # first day of the colder winter
TOML = """name = "b"
[records]
time_in_name = "%Y"
[[covariate]]
name = "temperature"
kink = 0.0
[reference]
to = "2024-12-31"
"""


def run(program, flags, seed):
    """Events of one realisation."""
    rng = np.random.default_rng(1000 + seed)
    hours = np.arange(0, flags.years * 365 * 24, flags.step_hours)
    loss = np.zeros((len(hours), generate.GROUPS))
    days = hours / 24 - flags.loss_day
    share = np.clip(days / flags.growth_days, 0, 1) if flags.growth_days else days >= 0
    loss[:, flags.group] = flags.loss * share
    late = hours / 24 >= COLD_DAY
    hz, temperature = generate.frequencies(rng, hours, flags.step_hours, flags.scatter,
                                           flags.noise, loss, flags.colder * late)
    shapes = generate.modes([1.0] * generate.GROUPS)[1]
    shapes = (shapes / np.abs(shapes).max(0)).astype(complex)
    there = rng.random(hz.shape) >= flags.missing
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "b.toml").write_text(TOML)
        command = [program, f"--structure={folder}/b.toml", f"--store={folder}/w.db", "--once",
                   f"--output_dir={folder}/D", "--overwrite"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        store = sqlite3.connect(folder / "w.db")
        for i, hour in enumerate(hours):
            store.execute("INSERT INTO record VALUES (?, 1, ?, '', ?, 600, '')",
                          (i + 1, str(i), EPOCH + 3600 * float(hour)))
            store.executemany("INSERT INTO channel VALUES (?, ?, ?, '')",
                              [(i + 1, c, f"a{c}") for c in range(shapes.shape[0])])
            store.executemany("INSERT INTO mode VALUES (?, ?, ?, ?, 0.01, 0.001, ?)",
                              [(i + 1, m, hz[i, m], flags.noise * hz[i, m],
                                np.ascontiguousarray(shapes[:, m]).tobytes())
                               for m in range(hz.shape[1]) if there[i, m]])
            store.execute("INSERT INTO covariate VALUES (?, 'temperature', ?)",
                          (i + 1, temperature[i]))
        store.commit()
        store.close()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return json.loads((folder / "D" / "watch.json").read_text())


def day_of(event):
    date = np.datetime64(event["time"].replace(" ", "T"))
    return (date - np.datetime64("2024-01-01T00:00")) / np.timedelta64(1, "D")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--program", default=ROOT / "build-release/apps/pinode_watch")
    parser.add_argument("--runs", type=int, default=8)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--years", type=int, default=3)
    parser.add_argument("--step_hours", type=float, default=1)
    parser.add_argument("--scatter", type=float, default=0.001)
    parser.add_argument("--noise", type=float, default=0.002)
    parser.add_argument("--missing", type=float, default=0.05)
    parser.add_argument("--loss", type=float, default=0)
    parser.add_argument("--loss_day", type=float, default=500)
    parser.add_argument("--growth_days", type=float, default=0)
    parser.add_argument("--group", type=int, default=0)
    parser.add_argument("--colder", type=float, default=0)
    parser.add_argument("--within", type=float)
    flags = parser.parse_args()
    flags.within = flags.within or flags.growth_days or 7
    counts, delays, cold, said = [], [], [], []
    for seed in range(flags.first, flags.first + flags.runs):
        result = run(flags.program, flags, seed)
        alarms = [day_of(e) for e in result["events"] if e["kind"] == "alarm"]
        before = [d for d in alarms if not flags.loss or d < flags.loss_day]
        after = [d - flags.loss_day for d in alarms if d >= flags.loss_day]
        counts.append(len(before))
        delays.append(after[0] if flags.loss and after else np.inf)
        chart = result["chart"]
        if flags.colder:
            cold.append(sum(d >= COLD_DAY for d in alarms if not flags.loss or d < flags.loss_day))
            said.append(any(day_of(e) >= COLD_DAY and "learned range" in e["text"]
                            for e in result["events"]))
        print(f"seed {seed}: {len(before)} false alarms, limits {chart['t2']['limit']:.2f} "
              f"{chart['average']['limit']:.2f}, memory {chart['scatter_memory_days']:.2f} d"
              + (f", found after {delays[-1]:.2f} days" if flags.loss else ""), flush=True)
    counted = (flags.loss_day / 365 if flags.loss else flags.years) - 1
    print(f"{sum(counts) / counted / flags.runs:.2f} false alarms a year "
          f"({sum(counts)} in {counted * flags.runs:.1f} years; most in one run {max(counts)})")
    if flags.colder:
        print(f"in the colder winter: {sum(cold)} false alarms in {flags.runs} winters, "
              f"outside of the learned range is said in {sum(said)}")
    if flags.loss:
        limit = flags.within
        found = sum(d <= limit for d in delays)
        print(f"{found} of {flags.runs} found within {limit:g} days, "
              f"median {np.median(delays):.2f} days")


if __name__ == "__main__":
    main()
