"""A real Firefox, in which tests open pages: over Marionette, the protocol that every Firefox speaks.

Playwright drives only a Firefox of its own, which no package registry has.
https://firefox-source-docs.mozilla.org/testing/marionette/Protocol.html
"""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

PROGRAM = next(filter(None, map(shutil.which, ("firefox-esr", "firefox"))), None)
#: How long it takes to start on a busy machine (s).
DEADLINE_S = 180
_PREFERENCES = """\
user_pref("marionette.port", {port});
user_pref("browser.shell.checkDefaultBrowser", false);
user_pref("datareporting.policy.dataSubmissionEnabled", false);
user_pref("network.captive-portal-service.enabled", false);
"""


class Firefox:
    """A running Firefox with one page."""

    def __init__(self, connection: socket.socket) -> None:
        self._socket = connection
        self._stream = connection.makefile("rb")
        self._count = 0
        self._read()
        self._call("WebDriver:NewSession", capabilities={})
        self._call("WebDriver:SetTimeouts", script=DEADLINE_S * 1000)

    def _read(self) -> Any:
        length = b""
        while (digit := self._stream.read(1)) not in (b":", b""):
            length += digit
        return json.loads(self._stream.read(int(length)))

    def _call(self, command: str, **given: Any) -> Any:
        self._count += 1
        data = json.dumps([0, self._count, command, given]).encode()
        self._socket.sendall(b"%d:%s" % (len(data), data))
        _, _, error, result = self._read()
        assert not error, error
        return result

    def open(self, address: str) -> None:
        """Load a page."""
        self._call("WebDriver:Navigate", url=address)

    def evaluate(self, script: str, *given: Any) -> Any:
        """Return what the body of an async function returns in the page; `given` are its `arguments`."""
        body = (
            "const done = arguments[arguments.length - 1];"
            f"(async function () {{ {script} }}).apply(null, arguments)"
            ".then(done, (error) => done(`error: ${error}`));"
        )
        return self._call("WebDriver:ExecuteAsyncScript", script=body, args=list(given))["value"]

    def wait_for(self, selector: str, text: str) -> str:
        """Return the text of the first element that this selects, once it contains `text`. Raises TimeoutError."""
        deadline = time.monotonic() + DEADLINE_S
        while text not in (found := self.evaluate(_TEXT, selector)):
            if time.monotonic() > deadline:
                raise TimeoutError(f"{selector} shows {found!r}, not {text!r}")
            time.sleep(0.1)
        return str(found)

    def click(self, label: str) -> None:
        """Press the button with this label."""
        assert self.evaluate(_CLICK, label) is True, f"no button {label!r}"

    def click_on(self, element: Any) -> None:
        """Click on an element that `evaluate` has returned, as a mouse does. Fails if something else covers it."""
        self._call("WebDriver:ElementClick", id=next(iter(element.values())))

    @contextmanager
    def in_another_tab(self) -> Iterator[None]:
        """Open a tab in front of the page, whose scripts can still be called: the page is hidden meanwhile."""
        page = self._call("WebDriver:GetWindowHandle")["value"]
        tab = self._call("WebDriver:NewWindow", type="tab", focus=True)["handle"]
        self._call("WebDriver:SwitchToWindow", handle=tab, focus=True)
        self._call("WebDriver:SwitchToWindow", handle=page, focus=False)
        yield
        self._call("WebDriver:SwitchToWindow", handle=tab, focus=True)
        self._call("WebDriver:CloseWindow")
        self._call("WebDriver:SwitchToWindow", handle=page, focus=True)

    def type(self, selector: str, keys: str) -> None:
        """Type into the element that this selects."""
        found = self._call("WebDriver:FindElement", using="css selector", value=selector)["value"]
        self._call("WebDriver:ElementSendKeys", id=next(iter(found.values())), text=keys)


_TEXT = "return document.querySelector(arguments[0])?.textContent ?? '';"
_CLICK = """
const found = document.querySelector(`button[aria-label="${arguments[0]}"]`);
found?.click();
return Boolean(found);
"""


@contextmanager
def firefox(profile: Path, *preferences: str) -> Iterator[Firefox]:
    """A running Firefox without a window, with a fresh profile in this folder, and with these lines of preferences."""
    assert PROGRAM is not None
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    (profile / "user.js").write_text("\n".join((_PREFERENCES.format(port=port), *preferences)))
    argv = [PROGRAM, "--headless", "--marionette", "--no-remote", "--profile", str(profile)]
    process = subprocess.Popen(argv, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        with _connected(port, process) as connection:
            yield Firefox(connection)
    finally:
        process.terminate()
        process.wait(60)


def _connected(port: int, process: subprocess.Popen[bytes]) -> socket.socket:
    deadline = time.monotonic() + DEADLINE_S
    while True:
        try:
            return socket.create_connection(("127.0.0.1", port), timeout=DEADLINE_S + 10)
        except OSError:
            assert process.poll() is None, "Firefox has ended"
            assert time.monotonic() < deadline, "Firefox does not answer"
            time.sleep(0.1)
