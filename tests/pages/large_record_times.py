#!/usr/bin/env python3
"""Times of the page of pinode_app with a record of 50 channels x 360,000 samples
(100 MB), and what becomes of an upload of 200 MB. By hand: no test depends on
times.

    tests/pages/large_record_times.py PROGRAM

Status 1 if the page is not usable in 2 s: open, with the first columns drawn.
Measured on two cores beside a load of 7: 3.6 s to send and read the file; then
0.2 s to open the page, 0.8 s with the first column, 1.1 s for the last one.
"""

import os
import shutil
import sys
import time
import urllib.request

import numpy as np

import chromium
from app_page import OPENER, App, Page

CHANNELS = 50
SAMPLES = 360000
MOST_SECONDS = 2.0
COLUMNS = "document.querySelectorAll('#columns .column')"


def write(path):
    random = np.random.default_rng(1)
    with open(path, "w", encoding="utf-8") as file:
        file.write("t [s]," + ",".join(
            f"a{i + 1} [m/s^2]" for i in range(CHANNELS)) + "\n")
        for begin in range(0, SAMPLES, 10000):
            rows = random.integers(-9999, 9999, size=(10000, CHANNELS))
            file.write("".join(
                f"{(begin + i) / 100:.2f}," + ",".join(map(str, row)) + "\n"
                for i, row in enumerate(rows.tolist())))


def send(app, content, name):
    request = urllib.request.Request(
        app.address + f"upload?name={name}&use=later", data=content,
        headers={"Content-Type": "application/octet-stream"}, method="POST")
    OPENER.open(request).close()


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    scratch = chromium.temporary_folder()
    app = App(os.path.abspath(sys.argv[1]), os.path.join(scratch, "works"),
              scratch)
    page = Page(1280)
    try:
        log = os.path.join(scratch, "large.csv")
        write(log)
        page.open(app.address)
        begin = time.monotonic()
        page.pick("#pick-baseline", log)
        page.wait("state.files.length === 1 && state.files[0].state === 'read'")
        print(f"sent and read: {time.monotonic() - begin:.2f} s")
        begin = time.monotonic()
        page.open(app.address)
        page.wait(f"{COLUMNS}.length === {CHANNELS}")
        print(f"page open: {time.monotonic() - begin:.2f} s")
        page.evaluate(f"{COLUMNS}[0].scrollIntoView()")
        page.wait(f"{COLUMNS}[0].dataset.drawn === '1'")
        usable = time.monotonic() - begin
        print(f"first column drawn: {usable:.2f} s")
        begin = time.monotonic()
        page.evaluate(f"{COLUMNS}[{CHANNELS - 1}].scrollIntoView()")
        page.wait(f"{COLUMNS}[{CHANNELS - 1}].dataset.drawn === '1'")
        last = time.monotonic() - begin
        print(f"last column drawn after scrolling there: {last:.2f} s")
        with open(log, "rb") as file:
            content = file.read()
        begin = time.monotonic()
        send(app, 2 * content, "twice.bin")
        sent = app.state()["files"][1]
        print(f"{2 * len(content) / 1e6:.0f} MB sent: "
              f"{time.monotonic() - begin:.2f} s; stored: {sent['size']} bytes, "
              f"{sent['state']}")
        return max(usable, last) > MOST_SECONDS
    finally:
        page.close()
        app.kill()
        shutil.rmtree(scratch, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
