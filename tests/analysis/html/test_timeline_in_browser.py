"""The timeline of a report, moved and searched in a real browser."""

from __future__ import annotations

from pathlib import Path

import pytest
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

from tests.analysis.html.browser import Page
from tests.analysis.html.sessions import ordinary
from woz_tui.analysis.html.report_page import write
from woz_tui.protocol import messages as m

pytestmark = pytest.mark.browser

WHOLE = (0.0, 120.0)


def width(view: tuple[float, float]) -> float:
    return round(view[1] - view[0], 3)


def focus(page: Page) -> None:
    page.run("document.querySelector('.plot').focus()")


def test_it_loads_without_a_complaint_and_asks_for_nothing(page: Page, single: Path) -> None:
    page.open(single)
    assert page.complaints() == []
    assert page.requests() == [single.as_uri()]
    assert page.view() == WHOLE
    assert not page.all(".static")


def test_keys_zoom_and_move(page: Page, single: Path) -> None:
    page.open(single)
    focus(page)
    page.keys("+", "+")
    assert width(page.view()) == 30
    page.keys(Keys.HOME)
    assert page.view() == (0, 30)
    page.keys(Keys.ARROW_RIGHT)
    assert page.view() == (6, 36)
    page.keys(Keys.PAGE_DOWN)
    assert page.view() == (36, 66)
    page.keys(Keys.ARROW_LEFT, Keys.PAGE_UP)
    assert page.view() == (0, 30)
    page.keys(Keys.END)
    assert page.view() == (90, 120)
    page.keys("-")
    assert page.view() == (60, 120)
    page.keys("0")
    assert page.view() == WHOLE


def test_keys_with_ctrl_and_in_the_search_field_are_not_the_timelines(
    page: Page, single: Path
) -> None:
    page.open(single)
    page.one("input[type=search]").click()
    page.keys("+", "n", Keys.HOME)
    assert page.view() == WHOLE
    assert page.one("input[type=search]").get_attribute("value") == "+n"


def test_buttons_zoom_and_move(page: Page, single: Path) -> None:
    page.open(single)
    page.one("button[aria-label='Zoom in']").click()
    assert page.view() == (30, 90)
    page.one("button[aria-label=Later]").click()
    assert page.view() == (60, 120)
    page.one("button[aria-label=Earlier]").click()
    page.one("button[aria-label='Zoom out']").click()
    assert page.view() == WHOLE
    page.one("button[aria-label='Zoom in']").click()
    page.one("button[aria-label='Show the whole session']").click()
    assert page.view() == WHOLE


def test_the_wheel_zooms_at_the_pointer_once_the_timeline_has_the_focus(
    page: Page, single: Path
) -> None:
    page.open(single)
    plot = page.one(".plot")
    page.run("arguments[0].scrollIntoView()", plot)
    origin = ScrollOrigin.from_element(plot)
    page.hands().scroll_from_origin(origin, 0, -300).perform()
    assert page.view() == WHOLE  # the page scrolls instead
    focus(page)
    page.run("arguments[0].scrollIntoView()", plot)
    before = page.run("return scrollY")
    page.hands().scroll_from_origin(origin, 0, -300).perform()
    page.until(lambda: width(page.view()) < 90)
    begin, end = page.view()
    assert 0 < begin < end < 120
    assert page.run("return scrollY") == before
    page.hands().scroll_from_origin(origin, 300, 0).perform()
    page.until(lambda: page.view()[0] > begin)


def test_dragging_moves_and_on_the_ruler_it_marks_what_to_see(page: Page, single: Path) -> None:
    page.open(single, "#t=40-80")
    lanes = page.one("svg.lanes")
    page.hands().move_to_element(lanes).click_and_hold().move_by_offset(-200, 0).release().perform()
    begin, end = page.view()
    assert 45 < begin < 60
    assert end - begin == pytest.approx(40)
    page.open(single)
    page.run("document.querySelector('svg.lanes').scrollIntoView()")
    top = -page.run("return document.querySelector('svg.lanes').clientHeight") // 2 + 8
    lanes = page.one("svg.lanes")
    hands = page.hands().move_to_element_with_offset(lanes, 0, top).click_and_hold()
    hands.move_by_offset(200, 30).perform()
    assert page.visible(".band") == 1
    page.hands().release().perform()
    begin, end = page.view()
    assert 15 < end - begin < 30
    assert not page.all(".band")


def test_two_fingers_pinch(page: Page, single: Path) -> None:
    page.open(single)
    box = page.run(
        "const box = document.querySelector('svg.lanes').getBoundingClientRect();"
        "return [box.left, box.top]"
    )

    def touch(kind: str, *places: int) -> None:
        points = [
            {"x": box[0] + place, "y": box[1] + 60, "id": finger}
            for finger, place in enumerate(places)
        ]
        touched = {"type": kind, "touchPoints": points}
        page.driver.execute_cdp_cmd("Input.dispatchTouchEvent", touched)

    touch("touchStart", 500)
    touch("touchStart", 500, 700)
    touch("touchMove", 400, 800)
    touch("touchEnd")
    assert width(page.view()) == pytest.approx(60, abs=2)


def test_the_line_below_shows_and_moves_what_is_seen(page: Page, single: Path) -> None:
    page.open(single, "#t=0-30")
    mini = page.one(".minimap")
    page.hands().move_to_element(mini).click().perform()
    begin, end = page.view()
    assert end - begin == pytest.approx(30)
    assert 35 < begin < 55
    page.hands().move_to_element(mini).click_and_hold().move_by_offset(150, 0).release().perform()
    assert page.view()[0] > begin + 5
    frame = page.one(".frame")
    assert float(frame.get_attribute("width") or 0) < 400


def test_the_pointer_shows_what_is_known(page: Page, single: Path) -> None:
    page.open(single)
    number = page.run(
        "return [...document.querySelectorAll('.events tbody tr')]"
        ".find(row => row.cells[2].textContent === 'Hello').dataset.number"
    )
    assert page.visible(".tip") == 0
    item = page.one(f".plot [data-number='{number}']")
    page.hands().move_to_element(item).perform()
    page.until(lambda: page.visible(".tip") == 1)
    tip = page.one(".tip").text
    assert "Hello" in tip
    assert "0:10.000 (10:00:10.000 UTC)" in tip
    assert "2.50 s" in tip
    assert "Hello, I am the guide." in tip
    assert "12" in tip
    assert page.text(".range").startswith("at 0:1")
    assert "distance" in page.text(".range")
    page.hands().move_to_element(page.one("h2")).perform()
    page.until(lambda: page.visible(".tip") == 0)


def test_a_click_chooses_and_the_list_follows(page: Page, single: Path) -> None:
    page.open(single)
    page.one(".plot .item .bar.s-failed").click()
    chosen = page.until(lambda: page.one("tr[aria-current]"))
    assert "Point" in chosen.text
    assert "failed" in page.text("[role=status]")
    page.keys(Keys.ESCAPE)
    assert not page.all("tr[aria-current]")
    assert not page.all(".chosen")


def test_events_can_be_stepped_through(page: Page, single: Path) -> None:
    page.open(single, "#t=10-20")
    focus(page)
    page.keys("n")
    first = page.text("[role=status]")
    assert "at 0:10.000" in first
    page.keys("n", "n")
    assert page.text("[role=status]") != first
    page.keys("p", "p")
    assert page.text("[role=status]") == first
    for _ in range(40):
        page.keys("n")
    assert "questionnaire" in page.text("tr[aria-current]")
    assert page.view()[1] >= 116


def test_a_row_of_the_list_leads_to_its_place(page: Page, single: Path) -> None:
    page.open(single)
    row = next(row for row in page.all(".events tbody tr") if "Bye" in row.text)
    row.find_elements(By.TAG_NAME, "td")[3].click()
    page.until(lambda: "Bye" in page.text("[role=status]"))
    begin, end = page.view()
    assert 60 < begin < 80
    assert 86 < end < 100
    assert "n=" in page.run("return location.hash")


def test_the_legend_hides_and_shows(page: Page, single: Path) -> None:
    page.open(single)
    rows = page.visible(".events tbody tr")
    done = len(page.all(".plot .bar.s-done"))
    chip = page.one(".chip[data-sort=done]")
    assert chip.text == f"done {done}"
    chip.click()
    assert chip.get_attribute("aria-pressed") == "false"
    assert page.all(".plot .bar.s-done") == []
    assert page.visible(".events tbody tr") == rows - done
    chip.click()
    assert len(page.all(".plot .bar.s-done")) == done
    assert page.visible(".events tbody tr") == rows


def test_lanes_can_be_hidden(page: Page, single: Path) -> None:
    page.open(single)
    height = page.one("svg.lanes").size["height"]
    page.one(".menu summary").click()
    for box in page.all(".choices label"):
        if box.text in {"Body", "distance"}:
            box.click()
    assert page.one("svg.lanes").size["height"] < height - 60
    titles = [title.text for title in page.all("svg.lanes .title")]
    assert "Body" not in titles
    assert "Speech" in titles
    assert not any("Nod" in row.text for row in page.all(".events tbody tr") if row.is_displayed())
    page.keys(Keys.ESCAPE)
    assert page.one(".menu").get_attribute("open") is None


def test_search_dims_what_does_not_fit_and_enter_goes_through_the_finds(
    page: Page, single: Path
) -> None:
    page.open(single)
    page.one("input[type=search]").send_keys("WHALE")
    assert page.text(".count") == "3 of 24"
    assert page.visible(".events tbody tr") == 3
    assert len(page.all(".item:not(.dim)")) == 3
    page.keys(Keys.ENTER)
    assert "How long is the whale?" in page.text("[role=status]")
    page.keys(Keys.ENTER)
    assert "18 metres" in page.text("[role=status]")
    page.keys(*[Keys.BACKSPACE] * 5)
    assert page.visible(".events tbody tr") == 24
    assert not page.all(".item.dim")


def test_the_address_keeps_what_is_seen(page: Page, single: Path) -> None:
    page.open(single, "#t=12.5-45")
    assert page.view() == (12.5, 45)
    focus(page)
    page.keys("+")
    page.until(lambda: page.run("return location.hash") == "#t=20.625-36.875")
    page.run("location.hash = '#t=1-2&n=0'")
    page.until(lambda: page.view() == (1, 2) or page.view() == (0, 1))
    assert page.all("tr[aria-current]")


@pytest.mark.parametrize(
    "address",
    ["#t=9-1", "#t=-3-5", "#t=a-b", "#n=9999", "#session-77&t=1-2", "#%00<b>", "#t=1e9-2e9"],
)
def test_an_address_that_means_nothing_is_ignored(page: Page, single: Path, address: str) -> None:
    page.open(single, address)
    assert page.complaints() == []
    assert page.view() in {WHOLE, (1.0, 2.0)}


def test_seen_from_near_there_are_ticks_of_milliseconds(page: Page, single: Path) -> None:
    page.open(single, "#t=10-10.05")
    ticks = [tick.text for tick in page.all("svg.lanes .tick")]
    assert "0:10.000" in ticks
    assert "0:10.005" in ticks
    assert 5 <= len(ticks) <= 16
    page.open(single)
    assert [tick.text for tick in page.all("svg.lanes .tick")][:3] == ["0:00", "0:10", "0:20"]


@pytest.mark.parametrize("years", [100, 70_000])
def test_a_damaged_time_of_many_years_makes_no_more_ticks(
    page: Page, tmp_path: Path, years: int
) -> None:
    story = ordinary()
    story.tell(years * 3e7, m.Note(text="a damaged line"))
    write([story.report(tmp_path)], tmp_path / "report.html")
    page.open(tmp_path / "report.html")
    assert 2 <= len(page.all("svg.lanes .tick")) < 100
    assert page.complaints() == []
