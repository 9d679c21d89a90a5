"""A headless Chromium that is spoken to through a pipe (DevTools protocol).

It depends on nothing of the machine but its program: home folder, settings and
temporary files are in a folder of its own, and every answer is waited for with
a limit that a slow machine does not reach.
"""

import base64
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

SOFTWARE_WEBGL = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
NO_WEBGL = ["--disable-gpu", "--disable-3d-apis"]
# Longest wait for one answer, and for a page.
PATIENCE_SECONDS = 300
STARTS = 3
# Shared memory and temporary files of one browser, and more.
ROOM_BYTES = 300 << 20

FLAGS = [
    "--headless=new", "--no-sandbox", "--no-first-run",
    "--no-default-browser-check", "--no-proxy-server",
    "--disable-extensions", "--disable-sync", "--disable-component-update",
    "--disable-background-networking", "--disable-default-apps",
    "--disable-breakpad", "--disable-crash-reporter",
    # Two windows are used in turn: neither is put to sleep.
    "--disable-background-timer-throttling",
    "--disable-backgrounding-occluded-windows",
    "--disable-renderer-backgrounding",
    "--password-store=basic", "--lang=en-US",
    "--remote-debugging-pipe", "--window-size=1000,900", "--hide-scrollbars"]


def has_room(folder):
    try:
        return (os.access(folder, os.W_OK | os.X_OK)
                and shutil.disk_usage(folder).free > ROOM_BYTES)
    except OSError:
        return False


def temporary_folder():
    """A new folder: the present one helps where the usual ones are full."""
    usual = tempfile.gettempdir()
    places = [usual, "/var/tmp", os.getcwd()]
    return tempfile.mkdtemp(
        prefix="page_", dir=next(filter(has_room, places), usual))


class Browser:
    """One browser with one page; end it with close()."""

    def __init__(self, flags):
        self.messages, self.process = [], None
        for left in range(STARTS - 1, -1, -1):
            self._start(flags)
            try:
                self._attach()
                return
            except RuntimeError as error:
                said = self.said()
                self.close()
                if left == 0:
                    raise RuntimeError(
                        f"chromium does not start: {error}; it said: {said}"
                    ) from error

    def _start(self, flags):
        self.folder = temporary_folder()
        home = os.path.join(self.folder, "home")
        os.mkdir(home)
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith(("XDG_", "CHROM"))}
        environment.pop("DISPLAY", None)
        environment.pop("DBUS_SESSION_BUS_ADDRESS", None)
        environment.update(HOME=home, TMPDIR=self.folder, LC_ALL="C.UTF-8")
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()

        def connect():  # 3 is read and 4 written by the browser
            os.dup2(to_browser, 10)
            os.dup2(from_browser, 11)
            os.dup2(10, 3)
            os.dup2(11, 4)
        memory = [] if has_room("/dev/shm") else ["--disable-dev-shm-usage"]
        with open(os.path.join(self.folder, "said.txt"), "wb") as said:
            self.process = subprocess.Popen(
                ["chromium"] + FLAGS + memory +
                ["--user-data-dir=" + os.path.join(self.folder, "data")] +
                flags + ["about:blank"],
                preexec_fn=connect, close_fds=False, env=environment,
                stdin=subprocess.DEVNULL, stdout=said, stderr=said,
                start_new_session=True)
        os.close(to_browser)
        os.close(from_browser)
        self._next, self._rest = 0, b""

    def _attach(self):
        end = time.monotonic() + PATIENCE_SECONDS
        while True:  # the page may come after the first answer
            targets = self.send("Target.getTargets",
                                at_page=False)["targetInfos"]
            pages = [t for t in targets if t["type"] == "page"]
            if pages:
                break
            if time.monotonic() > end:
                raise RuntimeError("it opens no page")
            time.sleep(0.02)
        self._session = self.send(
            "Target.attachToTarget", at_page=False,
            targetId=pages[0]["targetId"], flatten=True)["sessionId"]
        for part in ("Page", "Runtime", "Log"):
            self.send(part + ".enable")

    def send(self, method, at_page=True, **parameters):
        self._next += 1
        message = {"id": self._next, "method": method, "params": parameters}
        if at_page:
            message["sessionId"] = self._session
        try:
            os.write(self._out, json.dumps(message).encode() + b"\0")
        except BrokenPipeError:
            raise RuntimeError("the browser has ended") from None
        end = time.monotonic() + PATIENCE_SECONDS
        while True:
            answer = self._read(method, end)
            if answer.get("id") == self._next:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.messages.append(answer)

    def _read(self, method, end):
        while b"\0" not in self._rest:
            left = max(0.0, end - time.monotonic())
            if not select.select([self._in], [], [], left)[0]:
                raise RuntimeError(f"the browser does not answer to {method}")
            part = os.read(self._in, 1 << 20)
            if not part:
                raise RuntimeError("the browser has ended")
            self._rest += part
        text, self._rest = self._rest.split(b"\0", 1)
        return json.loads(text)

    def evaluate(self, expression):
        result = self.send("Runtime.evaluate", expression=expression,
                           awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(str(result["exceptionDetails"]))
        return result["result"].get("value")

    def wait(self, expression):
        """Waits until an expression is true, and returns it, or None."""
        end = time.monotonic() + PATIENCE_SECONDS
        while True:
            try:
                value = self.evaluate(expression)
                if value:
                    return value
            except RuntimeError:  # the page is about to change
                if self.process.poll() is not None:
                    raise
            if time.monotonic() > end:
                return None
            time.sleep(0.02)

    def open(self, path):
        """Opens a file and waits until its structure is there."""
        self.send("Page.navigate", url="file://" + os.path.abspath(path))
        if not self.wait(
                "document.readyState === 'complete' && "
                "(document.getElementById('structure') || {dataset: "
                "{state: 'none'}}).dataset.state !== 'loading'"):
            raise RuntimeError(f"{path} is never ready")

    def screenshot(self, path, **options):
        data = self.send("Page.captureScreenshot", format="png",
                         **options)["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))

    def errors(self):
        return [m["params"]["exceptionDetails"] for m in self.messages
                if m.get("method") == "Runtime.exceptionThrown"]

    def console(self):
        """The lines that the page has written to its console, errors too."""
        lines = []
        for message in self.messages:
            part = message.get("params", {})
            kind = message.get("method")
            if kind == "Runtime.consoleAPICalled":
                lines.append(part["type"] + ": " + " ".join(
                    str(a.get("value", a.get("description", "")))
                    for a in part["args"]))
            elif kind == "Log.entryAdded":
                entry = part["entry"]
                lines.append(f"{entry['level']}: {entry['text']} "
                             f"{entry.get('url', '')}")
            elif kind == "Runtime.exceptionThrown":
                details = part["exceptionDetails"]
                lines.append("exception: " + details.get("exception", {}).get(
                    "description", details["text"]))
        return lines

    def said(self):
        """The last that the program has written itself."""
        try:
            with open(os.path.join(self.folder, "said.txt"), "rb") as file:
                return file.read().decode(errors="replace")[-400:].strip()
        except OSError:
            return ""

    def close(self):
        if self.process is None:
            return
        try:  # with the processes that it has started
            os.killpg(self.process.pid, 9)
        except OSError:
            self.process.kill()
        self.process.wait()
        self.process = None
        os.close(self._out)
        os.close(self._in)
        shutil.rmtree(self.folder, ignore_errors=True)
