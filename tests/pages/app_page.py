"""A running pinode_app and its page in a browser, as a user handles it; and
what to say of both if a step fails."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
import traceback
import urllib.request

import chromium

# A proxy of the environment does not know this machine's own addresses.
OPENER = urllib.request.build_opener(urllib.request.ProxyHandler({}))
PATIENCE_SECONDS = chromium.PATIENCE_SECONDS
# Lines and width of the report on a failure: continuous integration shows the
# end of the output alone.
LINES_OF_A_PART = 3
WIDTH_OF_A_LINE = 300


class Failed(Exception):
    pass


def check(good, what):
    if not good:
        raise Failed(what)


def await_true(condition, what):
    end = time.monotonic() + PATIENCE_SECONDS
    while not condition():
        check(time.monotonic() < end, "never true: " + what)
        time.sleep(0.005)


class Steps:
    """Names and durations of the steps, and the report if one fails."""

    def __init__(self):
        self.name, self.app, self.pages = "start", None, []

    @contextlib.contextmanager
    def step(self, name):
        self.name = name
        begin = time.monotonic()
        yield
        print(f"{time.monotonic() - begin:5.1f} s  {name}", flush=True)

    def report(self, error):
        """Prints why it failed; nothing else may be printed after this."""
        traceback.print_exc(file=sys.stdout)
        lines = [f"FAILED at the step '{self.name}': {error}"]
        for page in self.pages:
            lines += page.report()
        if self.app is not None:
            lines += self.app.report()
        for line in lines:
            print(line.replace("\n", " ")[:WIDTH_OF_A_LINE], flush=True)


class App:
    """A running pinode_app. `scratch` takes its home folder and its words."""

    def __init__(self, program, folder, scratch):
        self._said = os.path.join(scratch, "app_said.txt")
        environment = dict(os.environ, HOME=scratch)
        with open(self._said, "wb") as said:
            self.process = subprocess.Popen(
                [program, "--open_browser=false", "--folder=" + folder],
                stdin=subprocess.DEVNULL, stdout=said,
                stderr=subprocess.STDOUT, env=environment)
        await_true(lambda: "\n" in self.said() or self.process.poll()
                   is not None, "pinode_app says its address")
        self.address = self.said().split("\n")[0]
        check(re.fullmatch(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/",
                           self.address), "no address: " + self.said())

    def said(self):
        with open(self._said, "rb") as file:
            return file.read().decode(errors="replace")

    def state(self):
        return json.loads(self.get("state"))

    def get(self, path):
        with OPENER.open(self.address + path,
                         timeout=PATIENCE_SECONDS) as answer:
            return answer.read().decode()

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def check_ended(self):
        """Checks that it ends well; it was asked to."""
        check(self.process.wait(timeout=PATIENCE_SECONDS) == 0,
              f"pinode_app ended with {self.process.returncode}")

    def report(self):
        status = self.process.poll()
        ended = "runs" if status is None else f"has ended with {status}"
        return [f"pinode_app {ended}; it said:"] + \
            ["  " + line for line in
             self.said().strip().split("\n")[-LINES_OF_A_PART:]]


class Page:
    """The page in a browser of some width."""

    def __init__(self, width, shots=None):
        self.browser = chromium.Browser(chromium.NO_WEBGL)
        self.width, self.shots = width, shots
        self.browser.send("Emulation.setDeviceMetricsOverride", width=width,
                          height=844, deviceScaleFactor=1,
                          mobile=width < 500)

    def open(self, address):
        self.browser.send("Page.navigate", url=address)
        self.wait("document.readyState === 'complete' && "
                  f"location.href === {json.dumps(address)} && "
                  "state.version > 0")

    def evaluate(self, expression):
        return self.browser.evaluate(expression)

    def wait(self, expression, fails=False):
        """Waits until it is true. A step that has failed is not waited for,
        unless it is to fail."""
        failed = "state.job && !state.job.running && state.job.problem"
        if fails:
            failed = "false"
        found = self.browser.wait(
            f"({expression}) ? 'true' : ({failed}) ? 'failed' : ''")
        check(found == "true", f"{'never' if found is None else 'not'} true "
              f"at {self.width} px: {expression}")

    def place(self, selector):
        """The middle of an element that can be seen, [x, y]; it is waited for
        until it stands still, and is not covered."""
        text = json.dumps(selector)
        where = f"""(() => {{
            const element = document.querySelector({text});
            if (!element) return null;
            element.scrollIntoView({{block: "center", behavior: "instant"}});
            const box = element.getBoundingClientRect();
            return [box.x + box.width / 2, box.y + box.height / 2];
        }})()"""
        last = None
        end = time.monotonic() + PATIENCE_SECONDS
        while True:
            now = self.evaluate(where)
            if now is not None and now == last:
                return now
            last = now
            check(time.monotonic() < end,
                  f"there is no {selector} that stands still "
                  f"at {self.width} px")

    def reach(self, selector, kind, act):
        """Does something at an element until the element has felt it.

        The page may be drawn anew between the question where an element is
        and the click at that place. A click that misses is taken away from
        what it meets, and done again.
        """
        # The browser answers when the page has handled the event.
        end = time.monotonic() + PATIENCE_SECONDS
        while True:
            x, y = self.place(selector)
            self.evaluate(f"""(() => {{
                const turn = window.turnOfTest = Math.random();
                window.reachedByTest = false;
                window.addEventListener("{kind}", (event) => {{
                    if (turn !== window.turnOfTest) return;
                    window.reachedByTest =
                        !!event.target.closest({json.dumps(selector)});
                    if (window.reachedByTest) return;
                    event.stopImmediatePropagation();
                    event.preventDefault();
                }}, {{capture: true, once: true}});
            }})()""")
            act(x, y)
            if self.evaluate("window.reachedByTest"):
                return
            check(time.monotonic() < end,
                  f"no {kind} reaches {selector} at {self.width} px")

    def press(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.browser.send("Input.dispatchMouseEvent", type=kind, x=x, y=y,
                              button="left", clickCount=1)

    def click(self, selector):
        text = json.dumps(selector)
        self.wait(f"!!document.querySelector({text}) && "
                  f"!document.querySelector({text}).disabled")
        self.reach(selector, "click", self.press)

    def fill(self, selector, text):
        """Types a text in place of what a field has, and leaves the field."""
        field = f"document.querySelector({json.dumps(selector)})"
        self.click(selector)
        self.wait(f"document.activeElement === {field}")
        self.evaluate(f"{field}.select()")
        self.browser.send("Input.insertText", text=text)
        self.wait(f"{field}.value === {json.dumps(text)}")
        for kind in ("keyDown", "keyUp"):
            self.browser.send("Input.dispatchKeyEvent", type=kind, key="Tab",
                              code="Tab", windowsVirtualKeyCode=9)

    def answer(self, name, text):
        self.fill(f"[data-answer={name}]", text)
        self.wait(f"state.answers['{name}'] === {json.dumps(text)}")

    def choose(self, selector, value):
        """Chooses an option, as its list does when it is closed."""
        element = f"document.querySelector({json.dumps(selector)})"
        option = f"option[value={json.dumps(value)}]"
        self.wait(f"!!{element}.querySelector({json.dumps(option)})")
        self.evaluate(f"{element}.value = {json.dumps(value)}; {element}"
                      ".dispatchEvent(new Event('change', {bubbles: true}))")

    def drop(self, selector, *paths):
        def act(x, y):
            for kind in ("dragEnter", "dragOver", "drop"):
                self.browser.send(
                    "Input.dispatchDragEvent", type=kind, x=x, y=y,
                    data={"items": [], "files": list(paths),
                          "dragOperationsMask": 1})
        self.reach(selector, "drop", act)

    def pick(self, selector, *paths):
        """Picks files as the chooser of files does when it is closed."""
        self.wait(f"!!document.querySelector({json.dumps(selector)})")
        found = self.browser.send(
            "Runtime.evaluate",
            expression=f"document.querySelector({json.dumps(selector)})")
        self.browser.send("DOM.setFileInputFiles", files=list(paths),
                          objectId=found["result"]["objectId"])

    def screenshot(self, name):
        if not self.shots:
            return
        height = self.evaluate("document.documentElement.scrollHeight")
        self.browser.screenshot(
            os.path.join(self.shots, f"app_{name}_{self.width}.png"),
            captureBeyondViewport=True,
            clip={"x": 0, "y": 0, "width": self.width,
                  "height": min(height, 9000), "scale": 1})

    def check_width(self):
        wide = self.evaluate("document.documentElement.scrollWidth")
        check(wide <= self.width, f"{wide} px wide on {self.width} px")

    def check_no_errors(self):
        check(not self.browser.errors(), str(self.browser.errors()))

    def report(self):
        lines = [f"page of {self.width} px:"]
        try:
            lines[0] += " " + str(self.evaluate(
                "'notice: ' + $('#notice').textContent + '; work: ' + "
                "state.work + '; job: ' + JSON.stringify(state.job)"))
            self.screenshot("failed")
        except (RuntimeError, OSError) as error:
            lines[0] += f" {error}; it said: {self.browser.said()}"
        return lines + ["  console: " + line for line in
                        self.browser.console()[-LINES_OF_A_PART:]]

    def close(self):
        self.browser.close()
