"""What each figure on the page is: shown at the figure, and in full at the end of the page.

The sentences are those of the measures, as in docs/reference/report.md and beside the CSV.
"""

from __future__ import annotations

from woz_tui.analysis.html.markup import Markup, tag
from woz_tui.analysis.measures import BY_NAME

#: Name in an address -> title on the page, and the measure that it stands for.
_MEASURES: dict[str, tuple[str, str]] = {
    "acts": ("Wizard actions", "wizard_actions"),
    "rate": ("Wizard actions per minute", "wizard_actions_per_minute"),
    "reaction": ("Reaction time", "reaction_median_s"),
    "early": ("Cues answered early", "cues_answered_early"),
    "missed": ("Missed cues", "cues_missed"),
    "superseded": ("Superseded cues", "cues_superseded"),
    "press": ("Press to start", "press_median_ms"),
    "done": ("Request to end", "action_median_s"),
    "gaps": ("Gaps", "gap_median_s"),
    "mistakes": ("Mistakes", "mistakes"),
    "engaged": ("Engaged", "engaged_share"),
    "episodes": ("Episodes", "episodes"),
    "differing": ("Settings differed", "settings_differ_s"),
    "stops": ("Stops", "stops"),
    "trials": ("Trials", "trials"),
}
_PERCENTILE = "half, and 95 of 100, of the values are at most this; linear between neighbours"


def defined(name: str, text: str = "") -> Markup:
    """The figure's title, leading to its definition."""
    title, measure = _MEASURES[name]
    meaning = BY_NAME[measure].meaning.replace("`", "")
    return tag("a", text or title, href=f"#about-{name}", title=meaning, class_="defined")


def glossary() -> Markup:
    """All definitions."""
    entries = [
        (tag("dt", title, id=f"about-{name}"), tag("dd", prose(BY_NAME[measure].meaning)))
        for name, (title, measure) in _MEASURES.items()
    ]
    return tag(
        "section",
        tag("h2", "What the figures mean", id="figures"),
        tag(
            "p",
            "Figures leave out what happened in trials that were aborted or excluded, unless all "
            "trials were asked for; timelines and lists of events show everything.",
        ),
        tag("dl", entries, tag("dt", "Median, p95"), tag("dd", _PERCENTILE), class_="glossary"),
        class_="figures",
        aria_labelledby="figures",
    )


def prose(text: str) -> list[Markup | str]:
    """A sentence whose words between backticks are names in a log or a table."""
    return [tag("code", part) if place % 2 else part for place, part in enumerate(text.split("`"))]
