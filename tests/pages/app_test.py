#!/usr/bin/env python3
"""The page of pinode_app in headless Chromium, by mouse and keys alone.

    tests/pages/app_test.py PROGRAM [FOLDER]

Two files of a logger are dropped on the page; floors, weights and places are
given; the case is checked and fitted; the later state is compared; and the
verdict names the storey that has lost stiffness. At 1280 and at 390 pixels of
width, where nothing is wider than the screen. Then: two tabs see one state, a
program that was killed in the middle of a fit goes on from its checkpoint, and
modes take three clicks. Sensors are put on the nodes of a deck. Screenshots go
to FOLDER. Status 77: there is no Chromium.
"""

import atexit
import base64
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import urllib.request

import chromium
import two_logs

# A proxy of the environment does not know this machine's own addresses.
OPENER = urllib.request.build_opener(urllib.request.ProxyHandler({}))
PATIENCE_SECONDS = 300  # on a machine with much other work
# Length of a record whose fit takes long enough to be stopped.
LONG_SECONDS = 300
# Sensors and forces of data/frame.
FRAME_PLACES = {"fx": "force:3153.1", "fy": "force:2151.2",
                "a1x": "1051.1", "a1y": "1051.2", "a2x": "1101.1",
                "a2y": "1101.2", "a3x": "1151.1", "a3y": "1151.2"}
TRUE_CHANGE_PERCENT = -100 * two_logs.LOST


def check(good, what):
    if not good:
        sys.exit("FAILED: " + what)


class App:
    """A running pinode_app."""

    def __init__(self, program, folder):
        # None is left behind where a check fails.
        atexit.register(lambda: self.process.kill())
        self.process = subprocess.Popen(
            [program, "--open_browser=false", "--folder=" + folder],
            stdout=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        check(re.fullmatch(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/",
                           self.address), "no address: " + self.address)

    def state(self):
        with OPENER.open(self.address + "state") as answer:
            return json.load(answer)

    def end(self, how=signal.SIGINT):
        self.process.send_signal(how)
        self.process.stdout.close()
        return self.process.wait(timeout=PATIENCE_SECONDS)


class Page:
    """The page in a browser of some width, as a user handles it."""

    def __init__(self, address, width, shots=None):
        self.browser = chromium.Browser(chromium.NO_WEBGL)
        self.width, self.shots = width, shots
        self.browser.send("Emulation.setDeviceMetricsOverride", width=width,
                          height=844, deviceScaleFactor=1,
                          mobile=width < 500)
        self.browser.send("Page.navigate", url=address)
        self.wait("document.readyState === 'complete' && state.version > 0")

    def evaluate(self, expression):
        return self.browser.evaluate(expression)

    def wait(self, expression):
        end = time.monotonic() + PATIENCE_SECONDS
        while time.monotonic() < end:
            try:
                if self.evaluate(expression):
                    return
            except RuntimeError:
                pass  # the page is about to change
            time.sleep(0.05)
        self.screenshot("failed")
        check(False, f"never true at {self.width} px: {expression}\n"
              f"notice: {self.evaluate('$(`#notice`).textContent')}\n"
              f"job: {self.evaluate('JSON.stringify(state.job)')}")

    def place(self, selector):
        """The middle of an element that can be seen."""
        self.wait(f"!!document.querySelector({json.dumps(selector)})")
        return self.evaluate(f"""(() => {{
            const element = document.querySelector({json.dumps(selector)});
            element.scrollIntoView({{block: "center", behavior: "instant"}});
            const box = element.getBoundingClientRect();
            return [box.x + box.width / 2, box.y + box.height / 2];
        }})()""")

    def reach(self, selector, kind, act):
        """Does something at an element until the element has felt it.

        The page may be drawn anew between the question where an element is
        and the click at that place. A click beside it is done again.
        """
        # The browser answers when the page has handled the event.
        for turn in range(20):
            x, y = self.place(selector)
            self.evaluate(f"""(() => {{
                const turn = window.turnOfTest = Math.random();
                window.reachedByTest = false;
                document.addEventListener("{kind}", (event) => {{
                    if (turn === window.turnOfTest) {{
                        window.reachedByTest =
                            !!event.target.closest({json.dumps(selector)});
                    }}
                }}, {{capture: true, once: true}});
            }})()""")
            act(x, y)
            if self.evaluate("window.reachedByTest"):
                return
            print(f"{kind} at {selector}: once more", file=sys.stderr)
            time.sleep(0.1 * turn)
        self.screenshot("failed")
        check(False, f"no {kind} reaches {selector} at {self.width} px")

    def press(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.browser.send("Input.dispatchMouseEvent", type=kind, x=x, y=y,
                              button="left", clickCount=1)

    def click(self, selector):
        self.wait(f"!document.querySelector({json.dumps(selector)}).disabled")
        self.reach(selector, "click", self.press)

    def fill(self, selector, text):
        self.click(selector)
        self.browser.send("Input.insertText", text=text)
        for kind in ("keyDown", "keyUp"):
            self.browser.send("Input.dispatchKeyEvent", type=kind, key="Tab",
                              code="Tab", windowsVirtualKeyCode=9)

    def drop(self, selector, *paths):
        def act(x, y):
            for kind in ("dragEnter", "dragOver", "drop"):
                self.browser.send(
                    "Input.dispatchDragEvent", type=kind, x=x, y=y,
                    data={"items": [], "files": list(paths),
                          "dragOperationsMask": 1})
        self.reach(selector, "drop", act)

    def pick(self, selector, *paths):
        """What the chooser of files does when it is closed."""
        found = self.browser.send(
            "Runtime.evaluate",
            expression=f"document.querySelector({json.dumps(selector)})")
        self.browser.send("DOM.setFileInputFiles", files=list(paths),
                          objectId=found["result"]["objectId"])

    def screenshot(self, name):
        if not self.shots:
            return
        height = self.evaluate("document.documentElement.scrollHeight")
        data = self.browser.send(
            "Page.captureScreenshot", format="png", captureBeyondViewport=True,
            clip={"x": 0, "y": 0, "width": self.width,
                  "height": min(height, 9000), "scale": 1})["data"]
        path = os.path.join(self.shots, f"app_{name}_{self.width}.png")
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))

    def check_width(self):
        wide = self.evaluate("document.documentElement.scrollWidth")
        check(wide <= self.width, f"{wide} px wide on {self.width} px")

    def close(self):
        check(not self.browser.errors(), str(self.browser.errors()))
        self.browser.close()


def answer_and_check(page):
    page.fill("[data-answer=storeys]", "5")
    page.wait("state.answers.storeys === '5'")
    page.fill("[data-answer=weights]", "900, 900, 900, 900, 700 kN")
    page.wait("(state.answers.weights || '').endsWith('700 kN')")
    page.wait("placeOf(allColumns()[5]) === '5'")
    page.click("#do-check")
    page.wait("state.is_checked")
    page.wait("!!document.querySelector('#check-result .verdict')")


def to_the_verdict(program, logs, width, shots):
    folder = tempfile.mkdtemp()
    app = App(program, folder)
    page = Page(app.address, width, shots)
    if width > 500:
        page.drop(".zone[data-use=baseline]", logs[0])
        page.drop(".zone[data-use=later]", logs[1])
    else:
        page.pick("#pick-baseline", logs[0])
        page.pick("#pick-later", logs[1])
    page.wait("state.files.length === 2 && "
              "state.files.every((file) => file.state === 'read')")
    page.place("#columns .column")
    page.wait("document.querySelector('#columns .column').dataset.drawn === '1'")
    page.check_width()
    page.screenshot("columns")

    # A missing answer is asked for, beside its field.
    page.click("#do-check")
    page.wait("!!document.querySelector('.asked [data-answer=storeys]')")
    answer_and_check(page)
    page.check_width()
    page.screenshot("checked")

    page.click("#do-fit")
    page.wait("state.result !== null && !state.job.running")
    check(app.state()["result"]["usable"], "the fit is not usable")
    page.click("#do-compare")
    page.wait("!!document.querySelector('#damage-verdict')")
    verdict = page.evaluate("$('#damage-verdict').textContent")
    check(f"k{two_logs.DAMAGED_STOREY}" in verdict and "Damage" in verdict,
          "the verdict is: " + verdict)
    groups = {group["name"]: group
              for group in page.evaluate("state.damage.groups")
              if re.fullmatch(r"k\d", group["name"])}
    check(len(groups) == 5, str(groups))
    for name, group in groups.items():
        is_lost = name == f"k{two_logs.DAMAGED_STOREY}"
        true = TRUE_CHANGE_PERCENT if is_lost else 0.0
        check(abs(100 * group["change"] - true) < 1.0,
              f"{name}: {100 * group['change']} %, expected {true} %")
        check((group["probability"] > 0.5) == is_lost,
              f"{name}: damaged with probability {group['probability']}")
    # The report is there, and cannot ask the server for anything.
    page.wait("!!document.querySelector('#compare-report iframe')")
    page.check_width()
    time.sleep(1)
    page.screenshot("verdict")
    case = os.path.join(folder, "work_1", "case.toml")
    with open(case, encoding="utf-8") as file, OPENER.open(
            app.address + "files/case.toml?save=1") as saved:
        check(file.read() == saved.read().decode(), "the saved case differs")
    page.close()
    check(app.end() == 0, "pinode_app did not end well")
    print(f"{width} px: {verdict}")
    return folder


def killed_in_a_fit(program, log):
    """Kills the fit of a long record, and goes on with it."""
    folder = tempfile.mkdtemp()
    app = App(program, folder)
    page, other = Page(app.address, 1280), Page(app.address, 390)
    page.pick("#pick-baseline", log)
    other.wait("state.files.length === 1")  # two tabs, one state
    answer_and_check(page)
    other.wait("state.is_checked")
    other.click("#do-fit")
    page.wait("state.job !== null && state.job.kind === 'fit'")
    work = os.path.join(folder, "work_1")

    def has_checkpoint():
        return any(name.startswith("result.partial-") and os.path.exists(
            os.path.join(work, name, "checkpoint.json"))
                   for name in os.listdir(work))
    end = time.monotonic() + PATIENCE_SECONDS
    while not has_checkpoint() and time.monotonic() < end:
        time.sleep(0.002)
    app.end(signal.SIGKILL)
    check(has_checkpoint(), "no checkpoint is left")
    page.browser.close()
    other.browser.close()

    app = App(program, folder)
    page = Page(app.address, 1280)
    page.wait("state.files.length === 1 && state.files[0].state === 'read'")
    check(page.evaluate("state.answers.storeys") == "5", "answers are lost")
    page.click("#unfinished button")
    page.wait("state.result !== null && !state.job.running")
    check(app.state()["result"]["usable"], "the continued fit is not usable")
    page.close()
    check(app.end() == 0, "pinode_app did not end well")
    shutil.rmtree(folder)
    print("killed in a fit: it goes on")


def stopped(program, log):
    """Stops the fit of a long record by the button, and goes on with it."""
    folder = tempfile.mkdtemp()
    app = App(program, folder)
    page = Page(app.address, 390)
    page.pick("#pick-baseline", log)
    answer_and_check(page)
    page.click("#do-fit")
    page.click("#fit-job .stop")
    page.wait("state.result !== null && !state.job.running")
    check(page.evaluate("state.result.termination") == "interrupted",
          "the fit was not stopped")
    check(os.path.exists(os.path.join(folder, "work_1", "result",
                                      "report.html")), "no report")
    page.click("#unfinished button")
    page.wait("state.result.termination === 'converged' && "
              "!state.job.running")
    page.close()
    check(app.end() == 0, "pinode_app did not end well")
    shutil.rmtree(folder)
    print("stopped by the button: it goes on")


def modes_in_three_clicks(program, logs, shots):
    folder = tempfile.mkdtemp()
    app = App(program, folder)
    page = Page(app.address, 390, shots)
    page.pick("#pick-baseline", logs[0])  # 1
    page.wait("state.files.length === 1 && state.files[0].state === 'read'")
    page.click("#find-modes")  # 2: that is all
    page.wait("!!document.querySelector('#modes-report iframe')")
    with open(os.path.join(folder, "work_1", "modes", "modes.json"),
              encoding="utf-8") as file:
        modes = json.load(file)["modes"]
    check(len(modes) >= 1, "no modes")
    page.close()
    app.end()
    shutil.rmtree(folder)
    print(f"modes of records alone: {len(modes)}")


def sensors_on_a_deck(program, width, shots):
    """Selects nodes on the structure of data/frame and puts sensors there."""
    # Chromium reads no file whose path has "..".
    data = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(
        os.path.abspath(__file__)))), "data", "frame")
    deck = [os.path.join(data, name) for name in sorted(os.listdir(data))
            if re.fullmatch(r"frame\.(inp|dof)|.*\.(sti|mas)\.gz", name)]
    folder = tempfile.mkdtemp()
    app = App(program, folder)
    page = Page(app.address, width, shots)
    page.click("input[name=kind][value=deck]")
    page.pick("#pick-deck", *deck)
    page.pick("#pick-baseline", os.path.join(data, "healthy_1.csv"))
    page.wait("state.files.length === %d && state.files.every("
              "(file) => file.state !== 'reading')" % (len(deck) + 1))
    page.wait("deck.view !== null && allColumns().length === 8")
    for column, place in FRAME_PLACES.items():
        node, direction = place.replace("force:", "").split(".")
        page.place("#deck-canvas")
        x, y = page.evaluate(f"""(() => {{
            const canvas = $("#deck-canvas"), box = canvas.getBoundingClientRect();
            const [x, y] = deckPoint(canvas, deck.index.get("{node}"));
            return [box.x + x, box.y + y];
        }})()""")
        for kind in ("mousePressed", "mouseReleased"):
            page.browser.send("Input.dispatchMouseEvent", type=kind, x=x, y=y,
                              button="left", clickCount=1)
        page.wait(f"$('#deck-node').textContent === 'Node {node}'")
        value = ("force:" if "force" in place else "") + direction
        page.evaluate(f"$('#deck-column').value = '{column}'; "
                      f"$('#deck-direction').value = '{value}'")
        page.click("#deck-put")
        page.wait(f"state.places['{column}'] === '{place}'")
    page.check_width()
    page.screenshot("deck")
    for name, text in (("deck_units", "N,m"), ("factor", "2"),
                       ("unit", "m/s^2"), ("force_unit", "N")):
        if name == "unit":
            page.click("#time-answers summary")
        page.fill(f"[data-answer={name}]", text)
        page.wait(f"state.answers['{name}'] === '{text}'")
    page.click("#do-check")
    page.wait("state.is_checked")
    check(page.evaluate("state.check.assessed"), "the deck cannot be fitted")
    page.close()
    check(app.end() == 0, "pinode_app did not end well")
    shutil.rmtree(folder)
    print(f"{width} px: sensors on a deck")


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    if shutil.which("chromium") is None:
        print("no chromium: nothing is tested")
        sys.exit(77)
    program = os.path.abspath(sys.argv[1])
    shots = sys.argv[2] if len(sys.argv) == 3 else None
    if shots:
        os.makedirs(shots, exist_ok=True)
    scratch = tempfile.mkdtemp()
    try:
        logs = [os.path.join(scratch, name)
                for name in ("before.csv", "after.csv")]
        two_logs.write_both(*logs)
        for width in (1280, 390):
            shutil.rmtree(to_the_verdict(program, logs, width, shots))
        for width in (1280, 390):
            sensors_on_a_deck(program, width, shots)
        long_log = os.path.join(scratch, "long.csv")
        two_logs.write(long_log, 3, LONG_SECONDS, two_logs.STIFFNESSES_KN_M)
        stopped(program, long_log)
        killed_in_a_fit(program, long_log)
        modes_in_three_clicks(program, logs, shots)
    finally:
        shutil.rmtree(scratch)


if __name__ == "__main__":
    main()
