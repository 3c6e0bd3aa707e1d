"""The documents as a site: built with all that they link to, and searched in a browser."""

from __future__ import annotations

import functools
import shutil
import subprocess
import threading
from collections.abc import Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import pytest

from tests.analysis.html.browser import Page, browser
from tests.peers.places import ROOT, place
from tools.docs_tree import gather

#: The search's field and its results lie in a tree of their own.
INSIDE = "[...document.querySelectorAll('*')].find(one => one.shadowRoot)?.shadowRoot"


class Quiet(SimpleHTTPRequestHandler):
    """Gives files, and says nothing of it."""

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - as the base class
        pass


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address at which it is served."""
    builder = place("site") / "bin" / "zensical"
    folder = tmp_path_factory.mktemp("site")
    gather(folder / "build" / "pages")
    config = shutil.copy(ROOT / "mkdocs.yml", folder)
    subprocess.run([builder, "build", "--strict", "--config-file", config], check=True, timeout=200)
    handler = functools.partial(Quiet, directory=folder / "build" / "site")
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.fixture(scope="module")
def opened(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Page]:
    with browser(tmp_path_factory.mktemp("profile"), "127.0.0.1") as page:
        yield page


@pytest.mark.browser
@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("preflight", "docs/how-to/trials.html"),
        ("deposit", "docs/how-to/bundle.html"),
        ("rosbridge", "docs/how-to/ros.html"),
    ],
)
def test_a_search_finds_the_page_and_asks_nobody_else(
    site: str, opened: Page, words: str, found: str
) -> None:
    opened.visit(f"{site}/index.html")
    opened.until(lambda: opened.run("return document.readyState") == "complete")
    opened.until(lambda: opened.all(".md-search__button"))
    opened.one(".md-search__button").click()
    opened.until(lambda: opened.run(f"return {INSIDE}?.activeElement?.tagName") == "INPUT")
    opened.keys(words)
    links = f"return [...{INSIDE}.querySelectorAll('a')].map(one => one.href.split(/[?#]/)[0])"
    opened.until(lambda: f"{site}/{found}" in opened.run(links))
    asked = [address for address in opened.requests() if address.startswith("http")]
    assert asked
    assert [address for address in asked if not address.startswith(site)] == []
