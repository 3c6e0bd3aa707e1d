"""Tables on the page, and what each figure is: shown at the figure, and in full at the end.

The sentences are those of the measures, as in docs/reference/report.md and beside the CSV.
"""

from __future__ import annotations

from functools import cache

from woz_tui.analysis.html.markup import Child, Markup, isolated, tag
from woz_tui.analysis.measures import BY_NAME, title_of
from woz_tui.analysis.report_table import AlarmText, LogText, ReportTable
from woz_tui.analysis.report_tables import DEFINED

_PERCENTILE = "half, and 95 of 100, of the values are at most this; linear between neighbours"


@cache
def defined(measure: str, text: str = "") -> Markup:
    """The title of a measure, leading to its definition."""
    meaning = BY_NAME[measure].meaning.replace("`", "")
    words = text or title_of(measure)
    return tag("a", words, href=f"#about-{measure}", title=meaning, class_="defined")


def table(found: ReportTable) -> Markup | None:
    """A table whose first column names its rows; None if there are none."""

    def cell(text: str) -> Child:
        if text in found.definitions:
            return defined(found.definitions[text], text)
        if isinstance(text, AlarmText) and text:
            return tag("strong", isolated(text), class_="bad")
        return isolated(text) if isinstance(text, LogText) else text

    if not found.rows:
        return None
    head = tag("tr", [tag("th", cell(each), scope="col") for each in found.heads])
    body = [
        tag("tr", tag("th", cell(first), scope="row"), [tag("td", cell(each)) for each in rest])
        for first, *rest in found.rows
    ]
    content = (tag("caption", found.title), tag("thead", head), tag("tbody", body))
    return wide(tag("table", content), found.title)


def wide(content: Markup, name: str) -> Markup:
    """A box that scrolls where its content is wider than the page."""
    return tag("div", content, class_="wide", tabindex=0, role="region", aria_label=name)


@cache
def glossary() -> Markup:
    """The definitions of all figures on the page."""
    entries = [
        (tag("dt", title_of(name), id=f"about-{name}"), tag("dd", prose(BY_NAME[name].meaning)))
        for name in DEFINED
    ]
    return tag(
        "section",
        tag("h2", "What the figures mean", id="figures"),
        tag(
            "p",
            "Figures leave out what happened in trials that do not count (aborted, excluded, "
            "practice, cut off), unless all trials were asked for; "
            "timelines and lists of events show everything.",
        ),
        tag(
            "dl",
            entries,
            tag("dt", "Median, p95 (95th percentile)"),
            tag("dd", _PERCENTILE),
            class_="glossary",
        ),
        class_="figures",
        aria_labelledby="figures",
    )


def prose(text: str) -> list[Markup | str]:
    """A sentence whose words between backticks are names in a log or a table."""
    return [tag("code", part) if place % 2 else part for place, part in enumerate(text.split("`"))]
