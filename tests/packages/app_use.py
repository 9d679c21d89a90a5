#!/usr/bin/env python3
"""Run by the scripts of this folder inside a bare Debian.

    app_use.py PROGRAM

The packaged pinode_app serves its page, reads a file, refuses who has no token,
and ends when it is told to.
"""

import json
import re
import signal
import subprocess
import sys
import tempfile
import urllib.error
import urllib.request

LOG = "t [s],base [m/s^2],acc_1 [m/s^2]\n" + "".join(
    f"{0.01 * i:.2f},{i % 7},{i % 5}\n" for i in range(300))


def main():
    with tempfile.TemporaryDirectory() as folder:
        process = subprocess.Popen(
            [sys.argv[1], "--open_browser=false", "--folder=" + folder],
            stdout=subprocess.PIPE, text=True)
        try:
            address = process.stdout.readline().strip()
            assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/", address), address
            with urllib.request.urlopen(address) as page:
                assert b"<title>pinode</title>" in page.read()
            urllib.request.urlopen(urllib.request.Request(
                address + "upload?name=a.csv&use=baseline", data=LOG.encode(),
                method="POST")).close()
            with urllib.request.urlopen(address + "state") as state:
                file = json.load(state)["files"][0]
            assert file["state"] == "read" and file["samples"] == 300, file
            try:
                urllib.request.urlopen(address[:-34] + "/state")
                raise AssertionError("served without a token")
            except urllib.error.HTTPError as error:
                assert error.code == 403, error
            process.send_signal(signal.SIGINT)
            assert process.wait(timeout=60) == 0, process.returncode
        finally:
            process.kill()
    print("pinode_app serves its page")


if __name__ == "__main__":
    main()
