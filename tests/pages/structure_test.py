#!/usr/bin/env python3
"""The structure in a report, in headless Chromium.

    tests/pages/structure_test.py [--times] REPORT.html [FOLDER]

It draws, turns by pointer and by keys, zooms, moves in its modes, one finger
scrolls past it, a force that nobody measured is an arrow and an element
without length a marker, it refers to nothing outside, is printed as a still
picture, and says so where there is no WebGL. Screenshots go to FOLDER. Status
77: there is no Chromium.

The time to open it and that of a frame while it turns (software rendering) are
printed. With --times they must be less than a second and 50 ms: by hand, on a
machine without other work.
"""

import json
import os
import re
import shutil
import statistics
import sys
import tempfile
import time

import chromium

MOST_SECONDS = 1.0
MOST_MILLISECONDS = 50.0
MOST_BYTES = 3 << 20
OPENINGS = 3


def check(good, what):
    if not good:
        sys.exit("FAILED: " + what)


SECTION = "document.getElementById('structure')"
# The bytes p of the canvas as it stands; what is put in calls done().
PIXELS = """(() => {
  pinodeStructure.turn(0, 0);
  return new Promise((done) => requestAnimationFrame(() => {
    const canvas = document.querySelector('#structure canvas');
    const paper = document.createElement('canvas');
    paper.width = canvas.width; paper.height = canvas.height;
    const pen = paper.getContext('2d');
    pen.drawImage(canvas, 0, 0);
    const p = pen.getImageData(0, 0, paper.width, paper.height).data;
    %s
  }));
})()"""
# Of the canvas as it stands: how many of its pixels are not white, and their
# mean colour, which a turn changes.
LOOK = PIXELS % """let drawn = 0, hash = 0;
    for (let i = 0; i < p.length; i += 4) {
      if (p[i] + p[i + 1] + p[i + 2] < 750) {
        ++drawn;
        hash = (hash * 31 + i + p[i]) % 1000000007;
      }
    }
    done([drawn / (p.length / 4), hash]);"""


def with_webgl(report, folder):
    browser = chromium.Browser(chromium.SOFTWARE_WEBGL)
    try:
        # The first may wait for the disk, or for others on the machine.
        seconds = []
        for _ in range(OPENINGS):
            browser.open(report)
            seconds.append(
                int(browser.evaluate(f"{SECTION}.dataset.ready") or 0) / 1000)
        check(browser.evaluate(f"{SECTION}.dataset.state") == "drawn",
              "not drawn: " + str(browser.evaluate(
                  f"{SECTION}.querySelector('.no-webgl').textContent")))
        browser.evaluate(f"{SECTION}.scrollIntoView()")
        share, at_first = browser.evaluate(LOOK)
        check(share > 0.02, f"only {share:.3f} of the picture is drawn")
        if folder:
            browser.screenshot(os.path.join(folder, "structure.png"))

        box = browser.evaluate(
            "(() => { const b = document.querySelector('#structure canvas')"
            ".getBoundingClientRect(); return [b.x + b.width / 2, "
            "b.y + b.height / 2]; })()")
        mouse = dict(button="left", clickCount=1)
        browser.send("Input.dispatchMouseEvent", type="mousePressed",
                     x=box[0], y=box[1], **mouse)
        browser.send("Input.dispatchMouseEvent", type="mouseMoved",
                     x=box[0] + 120, y=box[1] + 30, **mouse)
        browser.send("Input.dispatchMouseEvent", type="mouseReleased",
                     x=box[0] + 120, y=box[1] + 30, **mouse)
        dragged = browser.evaluate(LOOK)[1]
        check(dragged != at_first, "dragging does not turn it")
        turned = browser.evaluate(f"{SECTION}.dataset.turn")
        browser.evaluate(f"{SECTION}.querySelector('.scene').focus()")
        browser.send("Input.dispatchKeyEvent", type="keyDown",
                     key="ArrowLeft", code="ArrowLeft")
        check(browser.evaluate(f"{SECTION}.dataset.turn") != turned,
              "an arrow key does not turn it")
        away = browser.evaluate(f"{SECTION}.dataset.away")
        browser.send("Input.dispatchMouseEvent", type="mouseWheel", x=box[0],
                     y=box[1], deltaX=0, deltaY=-200)
        check(browser.wait(f"{SECTION}.dataset.away !== '{away}'"),
              "the wheel does not zoom")
        # Two fingers, apart.
        away = browser.evaluate(f"{SECTION}.dataset.away")
        for kind, gap in (("touchStart", 40), ("touchMove", 90)):
            browser.send("Input.dispatchTouchEvent", type=kind, touchPoints=[
                dict(x=box[0] - gap, y=box[1], id=1),
                dict(x=box[0] + gap, y=box[1], id=2)])
        browser.send("Input.dispatchTouchEvent", type="touchEnd",
                     touchPoints=[])
        check(browser.evaluate(f"{SECTION}.dataset.away") != away,
              "two fingers do not zoom")
        browser.evaluate(f"{SECTION}.querySelector('.whole').click()")
        touch(browser, box)

        # A mode moves without anybody's hand.
        modes = browser.evaluate(
            f"{SECTION}.querySelectorAll('.motion option').length - 1")
        check(modes >= 1, "no mode to show")
        choose = ("(() => { const m = document.querySelector('#structure "
                  ".motion'); m.value = '%s'; m.dispatchEvent(new "
                  "Event('change')); })()")
        browser.evaluate(choose % "0")
        moving = browser.evaluate(LOOK)[1]
        end = time.monotonic() + chromium.PATIENCE_SECONDS
        while browser.evaluate(LOOK)[1] == moving:
            check(time.monotonic() < end, "the mode does not move")
        if folder:
            browser.screenshot(os.path.join(folder, "mode.png"))
        # While a mode moves and the view turns: the most work there is.
        times = browser.evaluate("pinodeStructure.frames(60)")
        median = statistics.median(times)
        browser.evaluate(choose % "")
        browser.send("Emulation.setEmulatedMedia", media="print")
        still = browser.evaluate(
            "[getComputedStyle(document.querySelector('#structure .still'))"
            ".display, getComputedStyle(document.querySelector("
            "'#structure .scene')).display]")
        check(still == ["block", "none"], f"printed as {still}")
        if folder:
            browser.evaluate(f"{SECTION}.scrollIntoView()")
            browser.screenshot(os.path.join(folder, "print.png"))
        check(not browser.errors(), f"errors: {browser.errors()}")
    finally:
        browser.close()
    return min(seconds), median


# Waits until view and page have stood still for ten frames.
SETTLED = """(async () => {
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  const data = document.getElementById('structure').dataset;
  const state = () => [scrollY, data.turn, data.tilt, data.away].join();
  for (let last = "", still = 0; still < 10; last = state()) {
    await frame();
    still = state() === last ? still + 1 : 0;
  }
})()"""


def drag(browser, fingers, by):
    """Fingers, each (x, y), together by (x, y) in ten steps."""
    for step in range(11):
        browser.send(
            "Input.dispatchTouchEvent", type="touchMove" if step else "touchStart",
            touchPoints=[dict(x=x + step * by[0] / 10, y=y + step * by[1] / 10, id=i)
                         for i, (x, y) in enumerate(fingers)])
        browser.evaluate("new Promise((d) => requestAnimationFrame(d))")
    browser.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    browser.evaluate(SETTLED)


def touch(browser, box):
    """One finger scrolls past the view or turns it, two tilt it."""
    browser.send("Emulation.setTouchEmulationEnabled", enabled=True,
                 maxTouchPoints=2)
    state = f"[scrollY, {SECTION}.dataset.turn, {SECTION}.dataset.tilt]"
    two = [(box[0] - 40, box[1]), (box[0] + 40, box[1])]
    at_first = browser.evaluate(state)
    drag(browser, [box], (120, 0))
    across = browser.evaluate(state)
    check(across[0] == at_first[0] and across[1] != at_first[1],
          f"one finger across: {across}, {at_first} before")
    drag(browser, two, (0, -60))
    tilted = browser.evaluate(state)
    check(tilted[0] == across[0] and tilted[2] != across[2],
          f"two fingers up: {tilted}, {across} before")
    drag(browser, [box], (0, -150))
    scrolled = browser.evaluate(state)
    check(scrolled[0] > tilted[0] + 50 and scrolled[1:] == tilted[1:],
          f"one finger up: {scrolled}, {tilted} before")
    browser.send("Emulation.setTouchEmulationEnabled", enabled=False)
    browser.evaluate(f"{SECTION}.scrollIntoView()")
    browser.evaluate(f"{SECTION}.querySelector('.whole').click()")


# Pixels of a colour, #rrggbb.
COUNT = """const at = [1, 3, 5].map((i) => parseInt('%s'.substr(i, 2), 16));
    let count = 0;
    for (let i = 0; i < p.length; i += 4) {
      if (at.every((value, k) => Math.abs(p[i + k] - value) < 12)) ++count;
    }
    done(count);"""


def unmeasured_force(text, folder):
    """Beside what the report has, an arrow of a force that nobody measured."""
    tint = re.search(r'"tints":\["#\w+","#\w+","(#\w+)"\]', text).group(1)
    arrow = '{"direction":[0.0,0.0,-1.0],"name":"gust","node":0}'
    pushed, count = re.subn(r'"unknown_forces":\[\]',
                            f'"unknown_forces":[{arrow}]', text)
    check(count == 1, "the report has unmeasured forces of its own")
    browser = chromium.Browser(chromium.SOFTWARE_WEBGL)
    try:
        pixels = []
        with tempfile.TemporaryDirectory() as scratch:
            for name, page in (("without", text), ("with", pushed)):
                path = os.path.join(scratch, name + ".html")
                with open(path, "w", encoding="utf-8") as file:
                    file.write(page)
                browser.open(path)
                browser.evaluate(f"{SECTION}.scrollIntoView()")
                pixels.append(browser.evaluate(PIXELS % (COUNT % tint)))
                if folder:
                    browser.screenshot(os.path.join(folder, name + ".png"))
        check(pixels[1] > pixels[0] + 50,
              f"{pixels[1]} pixels of an unmeasured force, {pixels[0]} without")
        check(not browser.errors(), f"errors: {browser.errors()}")
    finally:
        browser.close()


def marker(text, folder):
    """What has no length is drawn, and told of where it is pointed at."""
    head, begin, rest = text.partition('class="structure-data">')
    data, end, tail = rest.partition("</script>")
    data = json.loads(data)
    for key in ("triangles", "triangle_groups", "edges", "lines", "line_groups",
                "sensors", "forces", "marks"):
        data[key] = []
    data["nodes"][:3] = [0.0, 0.0, 0.0]
    data["markers"], data["marker_groups"] = [0], [1]
    page = head + begin + json.dumps(data).replace("</", "<\\/") + end + tail
    browser = chromium.Browser(chromium.SOFTWARE_WEBGL)
    try:
        with tempfile.TemporaryDirectory() as scratch:
            path = os.path.join(scratch, "marker.html")
            with open(path, "w", encoding="utf-8") as file:
                file.write(page)
            browser.open(path)
        browser.evaluate(f"{SECTION}.scrollIntoView()")
        drawn = browser.evaluate(LOOK)[0]
        if folder:
            browser.screenshot(os.path.join(folder, "marker.png"))
        check(0.00005 < drawn < 0.01, f"a marker on {drawn:.6f} of the picture")
        box = browser.evaluate(
            "(() => { const b = document.querySelector('#structure canvas')"
            ".getBoundingClientRect(); return [b.x + b.width / 2, "
            "b.y + b.height / 2]; })()")
        browser.send("Input.dispatchMouseEvent", type="mouseMoved",
                     x=box[0], y=box[1])
        told = browser.evaluate(f"{SECTION}.querySelector('.told').textContent")
        check(":" in told, f"of the marker it says '{told}'")
        check(not browser.errors(), f"errors: {browser.errors()}")
    finally:
        browser.close()


def without_webgl(report, folder):
    browser = chromium.Browser(chromium.NO_WEBGL)
    try:
        browser.open(report)
        check(browser.evaluate(f"{SECTION}.dataset.state") == "still",
              "it does not notice that there is no WebGL")
        words = browser.evaluate(
            f"{SECTION}.querySelector('.no-webgl').innerText")
        check("WebGL" in words and "still picture" in words,
              f"without WebGL it says '{words}'")
        check(browser.evaluate(
            f"{SECTION}.querySelector('.still svg')"
            ".getBoundingClientRect().height") > 100, "no still picture")
        check(not browser.errors(), f"errors: {browser.errors()}")
        if folder:
            browser.evaluate(f"{SECTION}.scrollIntoView()")
            browser.screenshot(os.path.join(folder, "still.png"))
    finally:
        browser.close()


def main():
    timed = sys.argv[1] == "--times"
    names = sys.argv[2:] if timed else sys.argv[1:]
    report = names[0]
    folder = names[1] if len(names) > 1 else ""
    size = os.path.getsize(report)
    with open(report, encoding="utf-8") as file:
        text = file.read()
    check(size <= MOST_BYTES, f"{size} bytes, more than 3 MB")
    outside = re.findall(r'(?:src|href)="(?!#)[^"]*"', text)
    check(not outside, f"the page refers to {outside[:3]}")
    if shutil.which("chromium") is None:
        print("SKIPPED: there is no chromium")
        sys.exit(77)
    seconds, median = with_webgl(report, folder)
    print(f"{size / 1e6:.2f} MB; drawn {seconds:.2f} s after the page was "
          f"asked for; median frame {median:.1f} ms")
    if timed:
        check(seconds <= MOST_SECONDS, f"{seconds:.2f} s, more than a second")
        check(median <= MOST_MILLISECONDS, f"median frame of {median:.1f} ms")
    unmeasured_force(text, folder)
    marker(text, folder)
    without_webgl(report, folder)


if __name__ == "__main__":
    main()
