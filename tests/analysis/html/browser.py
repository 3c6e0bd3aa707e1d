"""A real browser without a window, in which a report is opened, used and looked at."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from selenium.webdriver import ActionChains, Chrome, ChromeOptions
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.remote.webelement import WebElement
from selenium.webdriver.support.ui import WebDriverWait

T = TypeVar("T")
#: No name can be looked up, and no address reached but those named behind it.
NOWHERE = "--host-resolver-rules=MAP * ~NOTFOUND"
#: Nothing of the browser's own goes to a network.
FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
    "--disable-dev-shm-usage",
)
#: Seconds after which what should have happened never will.
PATIENCE = 30


class Page:
    """A report in a browser."""

    def __init__(self, driver: Chrome) -> None:
        self.driver = driver
        self.size(1400, 900)

    def size(self, width: int, height: int) -> None:
        """The window's inside, in pixels."""
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)

    def open(self, file: Path, address: str = "") -> None:
        """Load the file anew, with what follows `#` in the address."""
        self.driver.get("about:blank")
        self._log("browser")
        self._log("performance")
        self.driver.get(file.as_uri() + address)
        self.until(lambda: self.run("return document.documentElement.dataset.ready") == "yes")

    def visit(self, address: str) -> None:
        """Load what a server has there."""
        self.driver.get("about:blank")
        self._log("browser")
        self._log("performance")
        self.driver.get(address)

    def run(self, script: str, *arguments: object) -> Any:
        """What a script in the page returns."""
        return self.driver.execute_script(script, *arguments)

    def until(self, holds: Callable[[], T]) -> T:
        """Wait until it holds."""
        return WebDriverWait(self.driver, PATIENCE, poll_frequency=0.05).until(lambda _: holds())

    def one(self, css: str) -> WebElement:
        """The first element."""
        return self.driver.find_element(By.CSS_SELECTOR, css)

    def all(self, css: str) -> list[WebElement]:
        """All elements."""
        return self.driver.find_elements(By.CSS_SELECTOR, css)

    def text(self, css: str) -> str:
        """What the first element says, seen or not."""
        return str(self.run("return document.querySelector(arguments[0]).textContent", css))

    def visible(self, css: str) -> int:
        """How many of the elements are seen."""
        seen = "[...document.querySelectorAll(arguments[0])].filter(one => one.checkVisibility())"
        return int(self.run(f"return {seen}.length", css))

    def view(self) -> tuple[float, float]:
        """The seconds that the first timeline shows, once a picture of them has been drawn."""
        drawn = self.run(
            "return new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => {"
            "const {from, to} = document.querySelector('.plot').dataset;"
            "done([Number(from), Number(to)])})))"
        )
        return round(drawn[0], 3), round(drawn[1], 3)

    def keys(self, *keys: str) -> None:
        """To whatever has the focus."""
        for key in keys:
            ActionChains(self.driver, duration=0).send_keys(key).perform()

    def hands(self) -> ActionChains:
        """Pointer and wheel, without pauses."""
        return ActionChains(self.driver, duration=0)

    def complaints(self) -> list[str]:
        """Errors and warnings since the page was opened."""
        return [entry["message"] for entry in self._log("browser")]

    def requests(self) -> list[str]:
        """Everything that was asked for since the page was opened, from wherever, unless the page's
        own policy forbade it.
        """
        log = self._log("performance")
        told = [json.loads(entry["message"])["message"] for entry in log]
        forbidden = {
            one["params"]["requestId"]
            for one in told
            if one["params"].get("blockedReason") == "csp"
        }
        return [
            one["params"]["request"]["url"]
            for one in told
            if one["method"] == "Network.requestWillBeSent"
            and one["params"]["requestId"] not in forbidden
        ]

    def _log(self, name: str) -> list[dict[str, Any]]:
        """What was added to the browser's log since it was asked for the last time."""
        return list(self.driver.get_log(name))  # type: ignore[no-untyped-call]


@contextmanager
def browser(profile: Path, *reached: str, trusts: str = "") -> Iterator[Page]:
    """A browser of its own; `profile` is an empty folder for its state, `reached` are the only
    computers that it can reach. `trusts`: what an authority signed with this key (base64 of its
    SHA-256) is right, as if it were installed.
    """
    options = ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    nowhere = ", ".join((NOWHERE, *(f"EXCLUDE {host}" for host in reached)))
    for flag in (*FLAGS, nowhere, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    if trusts:
        options.add_argument(f"--ignore-certificate-errors-spki-list={trusts}")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    # With both paths given selenium looks for nothing, and fetches nothing.
    driver = Chrome(options=options, service=Service(shutil.which("chromedriver")))
    try:
        yield Page(driver)
    finally:
        driver.quit()
