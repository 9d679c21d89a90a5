#!/usr/bin/env python3
"""Reads one of the files of pinode_text_speed with pandas' C engine, and prints
CPU time, speed and peak memory: text_speed.py FOLDER/plain.csv"""

import os
import resource
import sys
import time

import pandas

OPTIONS = {"plain.csv": {},
           "german.csv": {"sep": ";", "decimal": ","},
           "clock.csv": {"parse_dates": ["timestamp"]}}


def main():
    path = sys.argv[1]
    name = os.path.basename(path)
    before = time.process_time()
    table = pandas.read_csv(path, engine="c", **OPTIONS[name])
    seconds = time.process_time() - before
    megabytes = os.path.getsize(path) / 1e6
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6
    print("pandas %-21s %8.0f %8.2f %8.0f %8.0f   (%d rows)" %
          (name, megabytes, seconds, megabytes / seconds, peak, len(table)))


if __name__ == "__main__":
    main()
