"""A client of WebDriver BiDi, the protocol by which browsers are driven.

Chromium speaks it through chromedriver, Firefox by itself.
"""

from __future__ import annotations

import base64
import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection, connect

CHROMIUM = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
    # WebGL without a graphics card.
    *("--enable-unsafe-swiftshader", "--window-size=1500,1100"),
)
SCREEN = "-screen 0 1600x1200x24"
START = 120.0  # s, on a busy machine
# What the tests need, as Debian and Ubuntu call it.
PACKAGES = "chromium chromium-driver firefox-esr xvfb"
KEYS = {"Tab": "\ue004", "Left": "\ue012", "Up": "\ue013", "Right": "\ue014", "Down": "\ue015"}
KEYS |= {"Enter": "\ue007", "Space": " ", "Control": "\ue009", "Shift": "\ue008", "Home": "\ue011"}
KEYS |= {"End": "\ue010"}


class Failed(Exception):
    """A command that the browser refused, or a script that threw."""


class Browser:
    """One page of a browser."""

    def __init__(self, connection: ClientConnection, name: str) -> None:
        self.name = name
        self.console: list[str] = []
        self._connection = connection
        self._count = 0
        self._context = ""

    def open_tab(self) -> None:
        """Open a tab and use it; what its console says is kept."""
        self.send("session.subscribe", events=["log.entryAdded"])
        self._context = self.send("browsingContext.create", type="tab")["context"]

    def another(self) -> str:
        """Open another tab and use it; return the one used so far."""
        before = self._context
        self._context = self.send("browsingContext.create", type="tab")["context"]
        return before

    def use(self, tab: str) -> None:
        """Use a tab."""
        self._context = tab
        self.send("browsingContext.activate", context=tab)

    def close_tab(self) -> None:
        """Close the tab in use."""
        self.send("browsingContext.close", context=self._context)

    def size(self, width: int, height: int) -> None:
        """Set the size of the page."""
        viewport = {"width": width, "height": height}
        self.send("browsingContext.setViewport", context=self._context, viewport=viewport)

    def open(self, url: str) -> None:
        """Open a page and wait until it is loaded."""
        self.send("browsingContext.navigate", context=self._context, url=url, wait="complete")

    def run(self, script: str) -> Any:
        """Evaluate an expression, or wait for its promise, and return its value by JSON."""
        wrapped = f"(async () => JSON.stringify((await ({script})) ?? null))()"
        found = self.send(
            "script.evaluate",
            expression=wrapped,
            target={"context": self._context},
            awaitPromise=True,
            userActivation=True,
        )
        if found["type"] != "success":
            raise Failed(found["exceptionDetails"]["text"])
        return json.loads(found["result"]["value"])

    def wait(self, condition: str, seconds: float = 60.0) -> None:
        """Wait until an expression holds."""
        until = time.monotonic() + seconds
        while not self.run(f"Boolean({condition})"):
            if time.monotonic() > until:
                raise Failed(f"not within {seconds:g} s: {condition}; console: {self.console}")
            time.sleep(0.05)

    def element(self, selector: str) -> dict[str, str]:
        """Find an element."""
        found = self.send(
            "browsingContext.locateNodes",
            context=self._context,
            locator={"type": "css", "value": selector},
            maxNodeCount=1,
        )["nodes"]
        if not found:
            raise Failed(f"there is no {selector}")
        return {"sharedId": found[0]["sharedId"]}

    def click(self, selector: str) -> None:
        """Click on an element as a user does."""
        self.run(f"document.querySelector({selector!r}).scrollIntoView({{block: 'center'}})")
        origin = {"type": "element", "element": self.element(selector)}
        actions = [
            {"type": "pointerMove", "x": 0, "y": 0, "origin": origin},
            {"type": "pointerDown", "button": 0},
            {"type": "pointerUp", "button": 0},
        ]
        self._act("pointer", actions)

    def drag(self, selector: str, dx: int, dy: int, steps: int = 8) -> None:
        """Press on the middle of an element, move in steps, and release."""
        self.run(f"document.querySelector({selector!r}).scrollIntoView({{block: 'center'}})")
        origin = {"type": "element", "element": self.element(selector)}
        moves = [
            {"type": "pointerMove", "x": dx * k // steps, "y": dy * k // steps, "origin": origin}
            for k in range(steps + 1)
        ]
        down = {"type": "pointerDown", "button": 0}
        self._act("pointer", [moves[0], down, *moves[1:], {"type": "pointerUp", "button": 0}])

    def keys(self, *keys: str, holding: str = "") -> None:
        """Press keys, by name or character, one after the other."""
        actions = []
        if holding:
            actions.append({"type": "keyDown", "value": KEYS[holding]})
        for key in keys:
            actions += [
                {"type": kind, "value": KEYS.get(key, key)} for kind in ("keyDown", "keyUp")
            ]
        if holding:
            actions.append({"type": "keyUp", "value": KEYS[holding]})
        self._act("key", actions)

    def choose(self, selector: str, value: str) -> None:
        """Choose an option of a list, with the event of a user's choice."""
        self.run(
            f"(() => {{ const e = document.querySelector({selector!r}); e.value = {value!r};"
            " e.dispatchEvent(new Event('change', {bubbles: true})); })()"
        )

    def slide(self, selector: str, value: float) -> None:
        """Move a slider, with the event of a user's move."""
        self.run(
            f"(() => {{ const e = document.querySelector({selector!r}); e.value = {value!r};"
            " e.dispatchEvent(new Event('input', {bubbles: true})); })()"
        )

    def text(self, selector: str) -> str:
        """Return what an element says."""
        return str(self.run(f"document.querySelector({selector!r}).innerText"))

    def screenshot(self, selector: str = "") -> bytes:
        """Return a picture of the page, or of an element, as PNG."""
        # After the frame that is being drawn.
        self.run("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")
        more: dict[str, Any] = {}
        if selector:
            self.run(f"document.querySelector({selector!r}).scrollIntoView({{block: 'center'}})")
            more["clip"] = {"type": "element", "element": self.element(selector)}
        found = self.send("browsingContext.captureScreenshot", context=self._context, **more)
        return base64.b64decode(found["data"])

    def send(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command and return its result."""
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters}
        self._connection.send(json.dumps(message))
        while True:
            answer = json.loads(self._connection.recv(timeout=120))
            if answer.get("method") == "log.entryAdded":
                entry = answer["params"]
                if entry["level"] in ("error", "warn"):
                    self.console.append(f"{entry['level']}: {entry['text']}")
            if answer.get("id") == self._count:
                if answer["type"] == "error":
                    raise Failed(f"{method}: {answer['error']}: {answer['message']}")
                return dict(answer["result"])

    def _act(self, kind: str, actions: list[dict[str, Any]]) -> None:
        source = {"type": kind, "id": kind, "actions": actions}
        self.send("input.performActions", context=self._context, actions=[source])


@contextlib.contextmanager
def browser(name: str, dark: bool = False) -> Iterator[Browser]:
    """Start a browser, ``"chromium"`` or ``"firefox"``, and end it.

    Parameters
    ----------
    name
        Which.
    dark
        Whether it prefers a dark colour scheme.

    Raises
    ------
    Failed
        If it, or what drives it, is not installed.
    """
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        start = _chromium if name == "chromium" else _firefox
        with start(Path(profile), dark) as connection:
            made = Browser(connection, name)
            made.open_tab()
            yield made


def _program(*names: str, package: str) -> str:
    for name in names:
        if found := shutil.which(name):
            return found
    raise Failed(f"{names[0]} is not installed: apt-get install {package} (of {PACKAGES})")


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextlib.contextmanager
def _process(*command: str) -> Iterator[None]:
    quiet = subprocess.DEVNULL
    # In a group of its own, to end what it starts as well.
    process = subprocess.Popen(command, stdout=quiet, stderr=quiet, start_new_session=True)
    try:
        yield
    finally:
        os.killpg(process.pid, signal.SIGTERM)
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


@contextlib.contextmanager
def _chromium(profile: Path, dark: bool) -> Iterator[ClientConnection]:
    binary = _program("chromium", "chromium-browser", "google-chrome", package="chromium")
    driver, port = _program("chromedriver", package="chromium-driver"), _free_port()
    scheme = f"--blink-settings=preferredColorScheme={0 if dark else 1}"
    options = {"binary": binary, "args": [*CHROMIUM, scheme, f"--user-data-dir={profile}"]}
    wanted = {"webSocketUrl": True, "goog:chromeOptions": options}
    body = json.dumps({"capabilities": {"alwaysMatch": wanted}}).encode()
    base = f"http://127.0.0.1:{port}/session"
    with _process(driver, f"--port={port}"):
        found = _patiently(lambda: json.load(urllib.request.urlopen(base, body, timeout=START)))
        session = found["value"]
        with connect(session["capabilities"]["webSocketUrl"], max_size=None) as connection:
            try:
                yield connection
            finally:
                end = urllib.request.Request(f"{base}/{session['sessionId']}", method="DELETE")
                urllib.request.urlopen(end, timeout=20).close()


@contextlib.contextmanager
def _firefox(profile: Path, dark: bool) -> Iterator[ClientConnection]:
    binary, port = _program("firefox-esr", "firefox", package="firefox-esr"), _free_port()
    # Headless, Firefox has no WebGL without a graphics card; on a virtual display it has.
    display = _program("xvfb-run", package="xvfb")
    command = (display, "-a", "-s", SCREEN, binary, "--no-remote", "--profile", str(profile))
    (profile / "user.js").write_text(
        'user_pref("webgl.force-enabled", true);\nuser_pref("app.update.enabled", false);\n'
        'user_pref("datareporting.policy.dataSubmissionEnabled", false);\n'
        'user_pref("network.captive-portal-service.enabled", false);\n'
        'user_pref("browser.shell.checkDefaultBrowser", false);\n'
        f'user_pref("layout.css.prefers-color-scheme.content-override", {0 if dark else 1});\n'
    )
    with _process(*command, f"--remote-debugging-port={port}", "about:blank"):
        url = f"ws://127.0.0.1:{port}/session"
        with _patiently(lambda: connect(url, max_size=None)) as connection:
            hello = {"id": 0, "method": "session.new", "params": {"capabilities": {}}}
            connection.send(json.dumps(hello))
            answer = json.loads(connection.recv(timeout=START))
            if answer["type"] == "error":
                raise Failed(f"firefox refuses a session: {answer['message']}")
            yield connection


def _patiently(attempt: Any) -> Any:
    """Repeat what fails while a program starts."""
    until = time.monotonic() + START
    while True:
        try:
            return attempt()
        except OSError:
            if time.monotonic() > until:
                raise Failed(f"it did not start within {START:g} s") from None
            time.sleep(0.2)
