"""Whole reports in a real browser: many sessions, hostile text, no script, print, dark, small."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from selenium.webdriver.common.keys import Keys

from tests.analysis.html.browser import Page
from tests.analysis.html.sessions import HOSTILE, ordinary
from woz_tui.analysis.html import page_frame
from woz_tui.analysis.html.report_page import write
from woz_tui.analysis.session_reading import ReportExtras, read_report

pytestmark = pytest.mark.browser

#: Contrast of text on a bar, by WCAG 2.2 (1.4.3), of what is painted one over the other.
CONTRAST = """
const parts = (text) => text.match(/[\\d.]+/g).map(Number);
const over = (top, alpha, below) => top.map((one, n) => one * alpha + below[n] * (1 - alpha));
const light = (rgb) => rgb
  .map((one) => (one /= 255) <= 0.04045 ? one / 12.92 : ((one + 0.055) / 1.055) ** 2.4)
  .reduce((sum, one, n) => sum + one * [0.2126, 0.7152, 0.0722][n], 0);
const paper = parts(getComputedStyle(document.body).backgroundColor);
return [...document.querySelectorAll(".plot text.on")].map((text) => {
  const bar = getComputedStyle(text.parentNode.querySelector(".bar"));
  const below = over(parts(bar.fill).slice(0, 3), Number(bar.fillOpacity), paper);
  const ink = parts(getComputedStyle(text).fill).slice(0, 3);
  const [high, low] = [light(ink), light(below)].sort((a, b) => b - a);
  return [text.getAttribute("class"), (high + 0.05) / (low + 0.05)];
});
"""


@contextmanager
def seen_as(page: Page, media: str = "", **features: str) -> Iterator[None]:
    """As printed, or with what the reader prefers."""
    wished = [{"name": name.replace("_", "-"), "value": value} for name, value in features.items()]
    page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media, "features": wished})
    try:
        yield
    finally:
        page.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": []})


@contextmanager
def without_script(page: Page) -> Iterator[None]:
    """The browser executes nothing that stands in a page."""
    page.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        yield
    finally:
        page.driver.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


def accessible(page: Page) -> list[dict[str, Any]]:
    """What a screen reader is told: roles and names."""
    told = page.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})
    return [
        {"role": node["role"]["value"], "name": node.get("name", {}).get("value", "")}
        for node in told["nodes"]
        if not node["ignored"]
    ]


def test_hostile_text_is_only_text(page: Page, attack: Path) -> None:
    page.open(attack, "#session-2")
    page.until(lambda: page.all(".plot"))
    assert page.complaints() == []
    assert page.requests() == [attack.as_uri()]
    assert page.run("return window.hacked") is None
    kinds = "return [...document.querySelectorAll('script')].map(one => one.type)"
    assert page.run(kinds) == ["application/json"] * 3 + [""]
    assert not page.all("img, iframe, object, embed, form, base, [onerror]")
    for text in HOSTILE[:4]:
        assert text in page.text("#session-2 .events")
    page.run("document.querySelector('#session-2 .plot').focus()")
    for _ in range(12):
        page.keys("n")
    page.one("#session-2 input[type=search]").send_keys("<script>")
    assert page.visible("#session-2 .events tbody tr") > 0
    assert page.run("return window.hacked") is None
    assert page.complaints() == []


def test_right_to_left_text_turns_nothing_around_that_stands_beside_it(
    page: Page, attack: Path
) -> None:
    page.open(attack, "#session-1")
    row = page.until(
        lambda: page.run(
            "return [...document.querySelectorAll('#session-1 .events tbody tr')]"
            ".find(row => row.textContent.includes('right to left'))"
        )
    )
    # "12:34" reads from the left: the place of each of its letters rises.
    places = page.run(
        "const text = document.querySelector('#session-1 .brief').firstChild;"
        "return [...text.data].map((_, n) => { const range = document.createRange();"
        "range.setStart(text, n); range.setEnd(text, n + 1);"
        "return range.getBoundingClientRect().left; })"
    )
    assert row.is_displayed()
    assert places == sorted(places)


def test_markup_that_slipped_in_would_be_dead(page: Page, single: Path, tmp_path: Path) -> None:
    broken = single.read_text().replace(
        "</main>",
        "<script>window.hacked = 1</script><img src=x onerror='window.hacked = 2'>"
        "<a id=bait href='javascript:window.hacked = 3'>x</a></main>",
    )
    (tmp_path / "broken.html").write_text(broken)
    page.open(tmp_path / "broken.html")
    page.run("document.getElementById('bait').click()")
    assert page.run("return window.hacked") is None
    assert len(page.complaints()) >= 3
    assert page.requests() == [(tmp_path / "broken.html").as_uri()]


def test_it_can_be_read_without_javascript(page: Page, single: Path) -> None:
    with without_script(page):
        page.driver.get("about:blank")
        page.driver.get(single.as_uri())
        assert page.visible(".static svg.lanes") == 1
        assert page.visible(".static .legend span") == 17
        assert page.all(".tools, .plot") == []
        assert page.visible(".events tbody tr") == 24
        body = page.one("body").text
        assert "Hello, I am the guide." in body
        assert "It was friendly." in body
        assert "Key to robot" in body


def test_without_javascript_long_lists_say_what_they_leave_out(
    page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page_frame, "EVENTS", 10)
    write([ordinary().report(tmp_path)], tmp_path / "report.html")
    with without_script(page):
        page.driver.get((tmp_path / "report.html").as_uri())
        listed = page.visible(".events tbody tr")
        assert 5 < listed < 24
        words = f"Without JavaScript only {listed} of 24 are listed."
        assert words in page.one(".list").text
    page.open(tmp_path / "report.html")
    assert page.visible(".events tbody tr") == 24
    row = next(row for row in page.all(".events tbody tr") if "Hello" in row.text)
    assert "Hello, I am the guide." in row.text
    row.click()
    page.until(lambda: "Hello" in page.text("[role=status]"))


def test_many_sessions_are_drawn_when_they_are_opened(page: Page, tmp_path: Path) -> None:
    report = ordinary().report(tmp_path)
    write([report] * 100, tmp_path / "report.html", beside=False)
    page.open(tmp_path / "report.html")
    assert len(page.all("section.session")) == 100
    assert len(page.all(".strips .strip")) == 101
    assert page.all(".plot") == []
    page.one("table.sortable a[href='#session-98']").click()
    page.until(lambda: page.visible("#session-98 .plot svg.lanes") == 1)
    assert len(page.all(".plot")) == 1
    assert page.run(
        "const box = document.getElementById('session-98').getBoundingClientRect();"
        "return box.top >= -1 && box.top < innerHeight / 2"
    )
    page.run("document.querySelector('#session-98 .plot').focus()")
    page.keys("+")
    page.until(lambda: page.run("return location.hash") == "#session-98&t=30-90")
    page.one("#session-98 .events tbody tr a").click()
    page.until(lambda: page.run("return location.hash").startswith("#session-98&t=0-"))
    assert page.complaints() == []


def test_sessions_beside_the_page_are_pages_that_lead_back(page: Page, tmp_path: Path) -> None:
    stories = [ordinary(f"P{number:02}", "warm", f"S{number:02}") for number in (1, 2, 3)]
    write([each.report(tmp_path) for each in stories], tmp_path / "all of it.html", beside=True)
    page.open(tmp_path / "all of it.html")
    assert len(page.all("table.sortable tbody tr")) == 3
    assert page.all("section.session") == []
    page.one("table.sortable tbody tr:nth-child(2) a").click()
    page.until(lambda: page.visible(".plot") == 1)
    assert "P02" in page.text("h2")
    page.one("a[href='../all%20of%20it.html']").click()
    page.until(lambda: page.visible("table.sortable") == 1)
    assert page.complaints() == []


def test_an_address_opens_its_session(page: Page, several: Path) -> None:
    page.open(several, "#session-2&t=10-20")
    page.until(lambda: page.visible("#session-2 .plot") == 1)
    assert page.view() == (10, 20)
    assert page.run("return [...document.querySelectorAll('details[open]')].length") == 1


def test_the_overview_sorts_by_mouse_and_keyboard(page: Page, several: Path) -> None:
    page.open(several)

    def column(number: int) -> list[str]:
        cells = page.all(f"table.sortable tbody tr > :nth-child({number})")
        return [cell.text for cell in cells]

    assert column(1) == ["P01", "P02", "P03"]
    heads = page.all("table.sortable button.sort")
    heads[1].click()
    assert column(2) == ["cold", "warm", "warm"]
    heads[7].send_keys(Keys.ENTER)
    assert column(8) == ["1.00 s", "1.10 s", "1.90 s"] or column(8) == sorted(column(8))
    rising = column(1)
    heads[7].send_keys(Keys.ENTER)
    assert column(1) == rising[::-1]
    sorts = [head.get_attribute("aria-sort") for head in page.all("table.sortable thead th")]
    assert [sort for sort in sorts if sort] == ["descending"]


def test_everything_can_be_reached_with_tab_and_has_a_name(page: Page, single: Path) -> None:
    page.open(single)
    reached = set()
    for _ in range(60):
        page.keys(Keys.TAB)
        reached.add(
            page.run("const it = document.activeElement; return it.className || it.tagName")
        )
    assert {"SUMMARY", "defined", "BUTTON", "INPUT", "chip", "plot", "scroll"} <= reached
    nameless = [
        node
        for node in accessible(page)
        if not node["name"].strip()
        and node["role"] in {"button", "link", "searchbox", "application", "img", "region", "table"}
    ]
    assert nameless == []
    roles = [node["role"] for node in accessible(page)]
    assert roles.count("application") == 1
    assert roles.count("columnheader") > 30
    assert "checkbox" not in roles  # the menu is closed


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_on_bars_can_be_read(page: Page, single: Path, scheme: str) -> None:
    with seen_as(page, prefers_color_scheme=scheme):
        page.open(single, "#t=0-60")
        found = page.run(CONTRAST)
        page.run("location.hash = '#t=60-120'")
        page.until(lambda: page.view() == (60, 120))
        found += page.run(CONTRAST)
        paper = page.run("return getComputedStyle(document.body).backgroundColor")
    assert (paper == "rgb(255, 255, 255)") == (scheme == "light")
    kinds = {kind.split()[-1] for kind, _ in found}
    assert {"s-done", "s-engaged", "s-state", "s-trial", "s-stopped", "s-refused"} <= kinds
    assert [(kind, ratio) for kind, ratio in found if ratio < 4.5] == []


def test_a_link_counts_while_the_view_before_is_being_remembered(page: Page, single: Path) -> None:
    page.open(single, "#t=0-60")
    page.run("location.hash = '#t=60-120'; history.replaceState(null, '', '#t=0-60')")
    page.until(lambda: page.view() == (60, 120))


@pytest.mark.parametrize("width", [1400, 800, 360])
def test_nothing_is_wider_than_the_window(page: Page, several: Path, width: int) -> None:
    page.size(width, 600)
    try:
        page.open(several, "#session-1")
        page.until(lambda: page.visible("#session-1 .plot") == 1)
        assert page.run("return document.scrollingElement.scrollWidth") <= width
        page.view()
        assert page.one("svg.lanes").size["width"] <= width
    finally:
        page.size(1400, 900)


def test_on_paper_there_is_everything_but_the_buttons(page: Page, single: Path) -> None:
    page.open(single)
    page.size(700, 1000)  # between the margins of A4
    with seen_as(page, "print"):
        assert page.run("return document.scrollingElement.scrollWidth") <= 700
        assert page.visible(".tools, .help, .minimap") == 0
        assert page.visible("svg.lanes") == 1
        assert page.visible(".chip") == 17
        whole = "const it = document.querySelector('.scroll'); return it.scrollHeight"
        assert page.run(whole) == page.run(whole.replace("scrollHeight", "clientHeight"))
    page.size(1400, 900)
    printed = page.driver.execute_cdp_cmd("Page.printToPDF", {})
    assert base64.b64decode(printed["data"]).startswith(b"%PDF")


def test_damage_is_stated_in_red(page: Page, tmp_path: Path) -> None:
    path = ordinary().write(tmp_path)
    whole = path.read_bytes()
    path.write_bytes(whole[:2000] + b"\0\0rubbish\xff" + whole[2040:-30])
    write([read_report(path, extras=ReportExtras(timeline=True))], tmp_path / "report.html")
    page.open(tmp_path / "report.html")
    assert "This log is incomplete" in page.one(".damage").text
    red, green, blue = page.run(
        "return getComputedStyle(document.querySelector('.damage h3')).color.match(/\\d+/g)"
    )
    assert int(red) > 2 * int(green) > int(blue)
    assert page.visible("svg.lanes") == 1


def test_an_empty_session_is_a_page_too(page: Page, tmp_path: Path) -> None:
    story = ordinary()
    story.told.clear()
    write([story.report(tmp_path)], tmp_path / "report.html")
    page.open(tmp_path / "report.html", "#t=1-2")
    assert page.complaints() == []
    page.run("document.querySelector('.plot').focus()")
    page.keys("+", "n", "p", "0", Keys.END)
    assert page.complaints() == []
