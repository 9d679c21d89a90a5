"""A headless Chromium that is spoken to through a pipe (DevTools protocol)."""

import base64
import json
import os
import shutil
import subprocess
import tempfile
import time

SOFTWARE_WEBGL = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
NO_WEBGL = ["--disable-gpu", "--disable-3d-apis"]


class Browser:
    """One browser with one page; end it with close()."""

    def __init__(self, flags):
        self.folder = tempfile.mkdtemp()
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()

        def connect():  # 3 is read and 4 written by the browser
            os.dup2(to_browser, 10)
            os.dup2(from_browser, 11)
            os.dup2(10, 3)
            os.dup2(11, 4)
        self.process = subprocess.Popen(
            ["chromium", "--headless=new", "--no-sandbox", "--no-first-run",
             "--disable-extensions", "--disable-background-networking",
             "--disable-dev-shm-usage", "--no-proxy-server",
             "--remote-debugging-pipe", "--window-size=1000,900",
             "--hide-scrollbars", f"--user-data-dir={self.folder}"] + flags +
            ["about:blank"],
            preexec_fn=connect, close_fds=False,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self._next, self._rest, self.messages = 0, b"", []
        targets = self.send("Target.getTargets", at_page=False)["targetInfos"]
        page = next(t for t in targets if t["type"] == "page")
        self._session = self.send(
            "Target.attachToTarget", at_page=False,
            targetId=page["targetId"], flatten=True)["sessionId"]
        self.send("Page.enable")
        self.send("Runtime.enable")

    def send(self, method, at_page=True, **parameters):
        self._next += 1
        message = {"id": self._next, "method": method, "params": parameters}
        if at_page:
            message["sessionId"] = self._session
        os.write(self._out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._read()
            if answer.get("id") == self._next:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.messages.append(answer)

    def _read(self):
        while b"\0" not in self._rest:
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

    def open(self, path):
        """Opens a file and waits until its structure is there."""
        self.send("Page.navigate", url="file://" + os.path.abspath(path))
        end = time.monotonic() + 60
        while time.monotonic() < end:
            state = self.evaluate(
                "document.readyState === 'complete' && "
                "(document.getElementById('structure') || {dataset: "
                "{state: 'none'}}).dataset.state")
            if state and state != "loading":
                return
            time.sleep(0.01)
        raise RuntimeError("the page is not ready after a minute")

    def screenshot(self, path):
        data = self.send("Page.captureScreenshot", format="png")["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))

    def errors(self):
        return [m["params"]["exceptionDetails"] for m in self.messages
                if m.get("method") == "Runtime.exceptionThrown"]

    def close(self):
        self.process.kill()
        self.process.wait()
        os.close(self._out)
        os.close(self._in)
        shutil.rmtree(self.folder, ignore_errors=True)
