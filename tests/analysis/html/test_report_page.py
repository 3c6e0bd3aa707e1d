"""The page as a text: what it holds, what it refers to, how large it is."""

from __future__ import annotations

import base64
import gc
import hashlib
import json
import re
from collections import Counter
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest

from tests.analysis.html.pages import render
from tests.analysis.html.sessions import SessionLogBuilder, hostile, ordinary
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.html import report_page as page_module
from woz_tui.analysis.html.report_page import write, writing
from woz_tui.analysis.html.session_pages import SessionPages
from woz_tui.analysis.html.timeline_styles import SORTS
from woz_tui.analysis.participant_groups import GroupedSessions
from woz_tui.analysis.session_reading import ReportExtras, read_report
from woz_tui.protocol import messages as m

ASSETS = files("woz_tui.analysis.html") / "assets"
VOID = {"br", "col", "hr", "input", "link", "meta"}


class Structure(HTMLParser):
    """Elements in their order, and whether each that was opened was closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def all(self, name: str) -> list[dict[str, str | None]]:
        return [attributes for tag, attributes in self.elements if tag == name]


@pytest.fixture(scope="module")
def text(tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("logs")
    stories = (ordinary("P01", "warm", "S01"), ordinary("P02", "cold", "S02", 0.7), hostile())
    return render([story.report(folder) for story in stories])


def data(text: str, session: int) -> dict[str, Any]:
    found = re.search(rf'id="session-{session}-data">(.*?)</script>', text)
    assert found is not None
    read: dict[str, Any] = json.loads(found[1])
    return read


def test_every_element_is_closed_in_its_turn(text: str) -> None:
    assert Structure(text).open == []


def test_names_of_places_are_unique_and_links_lead_to_them(text: str) -> None:
    page = Structure(text)
    names = Counter(attrs["id"] for _, attrs in page.elements if "id" in attrs)
    assert [name for name, count in names.items() if count > 1] == []
    targets = {str(attrs["href"]).split("&")[0] for attrs in page.all("a") + page.all("use")}
    assert {target[1:] for target in targets} <= set(names)
    labels = {
        str(attrs["aria-labelledby"]) for _, attrs in page.elements if "aria-labelledby" in attrs
    }
    assert labels <= set(names)


def test_all_heads_of_tables_say_what_they_head(text: str) -> None:
    heads = Structure(text).all("th")
    assert len(heads) > 100
    assert {head.get("scope") for head in heads} == {"col", "row"}


def test_every_table_has_a_caption(text: str) -> None:
    assert text.count("<table") == text.count("<caption") > 10


def test_nothing_outside_is_referred_to(text: str) -> None:
    page = Structure(text)
    refer = [
        (tag, name, value)
        for tag, attrs in page.elements
        for name, value in attrs.items()
        if name in {"src", "href", "srcset", "action", "data", "style"} or name.startswith("on")
    ]
    assert refer
    assert [one for one in refer if one[1] != "href" or not str(one[2]).startswith("#")] == []
    assert re.search(r"@import|url\(", (ASSETS / "page.css").read_text()) is None


def test_the_policy_allows_the_pages_own_script_and_style_alone(text: str) -> None:
    [policy] = [
        str(one["content"])
        for one in Structure(text).all("meta")
        if one.get("http-equiv") == "Content-Security-Policy"
    ]
    for name, directive in (("script", "script-src"), ("style", "style-src")):
        found = re.findall(rf"<{name}>(.*?)</{name}>", text, re.DOTALL)
        assert len(found) == 1
        digest = base64.b64encode(hashlib.sha256(found[0].encode()).digest()).decode()
        assert f"{directive} 'sha256-{digest}';" in policy
    assert policy.startswith("default-src 'none';")
    assert "unsafe" not in policy


def test_the_script_makes_no_markup_out_of_text() -> None:
    sources = [one for one in ASSETS.iterdir() if one.name.endswith(".js")]
    assert len(sources) > 10
    for source in sources:
        code = re.sub(r"//.*", "", source.read_text())
        assert not re.search(
            r"innerHTML|outerHTML|insertAdjacent|document\.write|eval\(|Function\(", code
        )
        assert not re.search(r"fetch\(|XMLHttp|WebSocket|import\(|localStorage", code)
        assert len(source.read_text().splitlines()) < 400


def test_every_sort_has_a_colour(text: str) -> None:
    style = (ASSETS / "page.css").read_text()
    assert [
        sort for sort in SORTS if not re.search(rf"\.s-{sort}\b[^{{]*\{{[^}}]*fill:", style)
    ] == []


def test_settings_that_differed_are_told_and_drawn(text: str, tmp_path: Path) -> None:
    lanes = {lane["title"]: lane for lane in data(text, 1)["lanes"]}
    [volume] = lanes["settings differ"]["items"]
    assert volume[:4] == [102.0, 112.0, "volume", "differing"]
    assert volume[4] == [["driver", "head"], ["had", "0.8"], ["wanted", "0.6"]]
    assert text.count("<caption>Robot settings that differed from the requested ones") == 3
    quiet = ordinary()
    quiet.told = [each for each in quiet.told if not isinstance(each[1], m.SettingsShown)]
    page = render([quiet.report(tmp_path)])
    assert "settings differ" not in [lane["title"] for lane in data(page, 1)["lanes"]]
    assert "<caption>Robot settings that differed" not in page


def test_data_name_everything_that_happened(text: str) -> None:
    lanes = {lane["title"]: lane for lane in data(text, 1)["lanes"]}
    assert list(lanes)[-2:] == ["distance", "loudness"]
    [hello] = [item for item in lanes["Speech"]["items"] if item[2] == "Hello"]
    assert hello[:4] == [10.0, 12.5, "Hello", "done"]
    assert ["say", "Hello, I am the guide."] in hello[4]
    sorts = {item[3] for lane in lanes.values() for item in lane.get("items", [])}
    assert {"failed", "refused", "stopped", "left-out", "break", "stop", "lost"} <= sorts


def test_sentences_typed_on_the_spot_have_a_lane(tmp_path: Path) -> None:
    story = SessionLogBuilder()
    told: dict[str, m.Json] = {"text": "Mind the step."}
    story.tell(3, m.Command(command="c1", verb="say", args=told, driver="voice", source="wizard"))
    story.tell(3.02, m.Dispatched(command="c1", driver="voice", latency_us=20_000))
    story.tell(5, m.TimedOut(command="c1", driver="voice", reason="it took too long"))
    [lane] = data(render([story.report(tmp_path)]), 1)["lanes"]
    assert lane["title"] == "(improvised)"
    [[*what, facts]] = lane["items"]
    assert what == [3, 5, "say", "failed"]
    assert ["say", "Mind the step."] in facts
    assert ["detail", "it took too long"] in facts


def test_only_sessions_with_participants_are_compared(tmp_path: Path) -> None:
    builder = SessionLogBuilder(session="S04")
    builder.tell(1, m.RerunStarted(original="x", original_session="S01"))
    stories = (ordinary("P01", "warm"), ordinary("P02", "cold", "S02"), builder)
    page = render([story.report(tmp_path) for story in stories])
    [compared] = re.findall(r'<table class="sortable">.*?</table>', page, re.DOTALL)
    sessions = set(re.findall(r"S0\d", re.sub(r"<[^>]+>", " ", compared)))
    assert sessions == {"S01", "S02"}
    overview = page.partition("Re-runs")[2].partition("</div>")[0]
    assert "S04" in overview


def test_slow_sensors_have_curves_without_holes(text: str) -> None:
    lanes = {lane["title"]: lane for lane in data(text, 1)["lanes"]}
    points = lanes["distance"]["points"]
    assert len(points) == 240
    assert None not in [value for _, value in points]
    assert lanes["distance"]["low"] == 0


def test_sensors_of_robots_with_names_have_curves(tmp_path: Path) -> None:
    story = SessionLogBuilder()
    for place in range(40):
        for robot in ("left", "right"):
            story.tell(place / 2, m.reading(f"{robot}.distance", 1.0, unit="m"))
    lanes = [lane["title"] for lane in data(render([story.report(tmp_path)]), 1)["lanes"]]
    assert lanes == ["left.distance", "right.distance"]


def test_a_sensor_that_was_silent_leaves_a_hole(tmp_path: Path) -> None:
    story = SessionLogBuilder()
    for place in [*range(20), *range(80, 100)]:
        story.tell(place / 2, m.reading("distance", 1.0, unit="m"))
    [lane] = data(render([story.report(tmp_path)]), 1)["lanes"]
    holes = [t for t, value in lane["points"] if value is None]
    assert len(holes) == 1
    assert 9.5 < holes[0] < 10.5


def test_an_hour_of_fast_sensors_stays_small(tmp_path: Path) -> None:
    story = SessionLogBuilder()
    for place in range(36_000):
        story.tell(place / 10, m.reading("distance", 1 + place % 7 / 7, unit="m"))
    for place in range(600):
        story.act(place * 6.0, f"Action {place % 9}", "Speech", 2)
    small = render([SessionLogBuilder().report(tmp_path)])
    large = render([story.report(tmp_path)])
    assert len(large) - len(small) < 600_000
    assert len(data(large, 1)["lanes"][-1]["points"]) <= 1500


def test_a_report_without_a_timeline_is_a_page_too(tmp_path: Path) -> None:
    page = Structure(render([read_report(ordinary().write(tmp_path))]))
    assert page.open == []
    assert len(page.all("section")) == 2


def test_figures_stand_in_the_page_as_they_were_found(text: str, tmp_path: Path) -> None:
    figures = ordinary("P01", "warm", "S01").report(tmp_path).figures
    plain = re.sub(r"<[^>]+>", " ", text)
    assert f"{figures.whole.acts} wizard actions" in plain
    assert "It was friendly." in plain


def test_a_page_that_cannot_be_written_leaves_what_was_there(tmp_path: Path) -> None:
    (tmp_path / "report.html").mkdir()
    (tmp_path / "report.html" / "old").touch()
    with pytest.raises(OSError, match=r"report\.html'$"):
        write([SessionLogBuilder().report(tmp_path)], tmp_path / "report.html")
    assert (tmp_path / "report.html" / "old").exists()


def test_a_page_is_for_its_owner_only_as_logs_are(tmp_path: Path) -> None:
    (tmp_path / "report.html").touch(0o644)
    write([SessionLogBuilder().report(tmp_path)], tmp_path / "report.html")
    assert (tmp_path / "report.html").stat().st_mode & 0o777 == 0o600


def test_a_folder_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"missing/report\.html'$"):
        write([SessionLogBuilder().report(tmp_path)], tmp_path / "missing" / "report.html")


def test_writing_leaves_one_file(tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    report = SessionLogBuilder().report(tmp_path / "logs")
    write([report], tmp_path / "report.html")
    write([report], tmp_path / "report.html")
    assert sorted(one.name for one in tmp_path.iterdir()) == ["logs", "report.html"]


def test_beside_the_page_each_session_has_one_of_its_own(tmp_path: Path) -> None:
    stories = [ordinary(f"P{number:02}", "warm", f"S{number:02}") for number in range(1, 4)]
    reports = [story.report(tmp_path) for story in stories]
    write([*reports, reports[0]], tmp_path / "report.html", beside=True)
    page = Structure((tmp_path / "report.html").read_text())
    assert [each for each in page.all("section") if each.get("class") == "session"] == []
    linked = {str(each["href"]) for each in page.all("a") if not str(each["href"]).startswith("#")}
    assert len(linked) == 4  # the copy has another name
    for name in linked:
        written = (tmp_path / name).read_text()
        assert Structure(written).open == []
        assert len(data(written, 1)["lanes"]) > 5
        assert 'href="../report.html"' in written
        assert (tmp_path / name).stat().st_mode & 0o777 == 0o600
    assert (tmp_path / "report.sessions").stat().st_mode & 0o777 == 0o700


def test_a_page_of_a_session_that_is_reported_no_more_is_removed(tmp_path: Path) -> None:
    stories = [ordinary(f"P{number:02}", "warm", f"S{number:02}") for number in range(1, 4)]
    reports = [story.report(tmp_path) for story in stories]
    write(reports, tmp_path / "report.html", beside=True)
    folder = tmp_path / "report.sessions"
    (folder / "of-somebody-else.html").write_text("<title>Notes</title>")
    write(reports[:2], tmp_path / "report.html", beside=True)
    assert sorted(path.name for path in folder.iterdir()) == [
        f"{reports[0].figures.stem}.html",
        f"{reports[1].figures.stem}.html",
        "of-somebody-else.html",
    ]


def test_above_a_number_of_sessions_they_are_beside_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(page_module, "INSIDE", 1)
    report = SessionLogBuilder().report(tmp_path)
    write([report], tmp_path / "one.html")
    assert not (tmp_path / "one.sessions").exists()
    write([report, report], tmp_path / "two.html")
    assert len(list((tmp_path / "two.sessions").iterdir())) == 2


@pytest.mark.parametrize("beside", [True, False])
def test_sessions_are_not_kept_while_a_page_is_written(tmp_path: Path, beside: bool) -> None:
    path = ordinary().write(tmp_path)
    grouped = GroupedSessions()
    kept = []
    pages = SessionPages(tmp_path / "report.html") if beside else None
    with writing(tmp_path / "report.html", grouped, 5, pages) as page:
        for _ in range(5):
            report = read_report(path, extras=ReportExtras(timeline=True))
            grouped.add(report.figures)
            page.add(report)
            del report
            kept.append(sum(type(each) is SessionFigures for each in gc.get_objects()))
    assert kept == [0 if beside else 1, 0, 0, 0, 0]  # the first one waits: maybe it is alone


@pytest.mark.parametrize("years", [100, 70_000])
def test_a_damaged_time_of_many_years_makes_no_more_ticks(tmp_path: Path, years: int) -> None:
    story = ordinary("P01", "warm", "S01")
    story.tell(years * 3e7, m.Note(text="a damaged line"))
    page = Structure(render([story.report(tmp_path)]))
    ticks = [attrs for attrs in page.all("text") if "tick" in str(attrs.get("class")).split()]
    assert 2 <= len(ticks) < 100
