"""What each figure on the page is, in a sentence: shown at the figure and at the end of the page.

docs/report.md has them in full.
"""

from __future__ import annotations

from woz_tui.analysis.html.markup import Markup, tag

#: Name in an address -> title, meaning.
DEFINITIONS: dict[str, tuple[str, str]] = {
    "acts": (
        "Acts by hand",
        "Actions and single commands that a human asked for: not those of a program or of the "
        "engagement model.",
    ),
    "rate": ("Acts a minute", "Acts by hand, divided by the time in which they could happen."),
    "reaction": (
        "Reaction time",
        "From a cue (the visitor's speech ends, the engagement changes, a marker) to the request "
        "of the next act by hand, if it comes within the window.",
    ),
    "missed": ("Missed cues", "Cues after which no act by hand came within the window."),
    "press": (
        "Press to start",
        "From the request by hand to the moment at which the driver was asked to perform the "
        "first command: what the software adds.",
    ),
    "done": (
        "Request to end",
        "From the request of an action to its end, of actions that were done.",
    ),
    "gaps": ("Gaps", "Between two acts by hand, one after the other."),
    "mistakes": (
        "Mistakes",
        "Acts that the wizard called a mistake; the rate is their share of the acts by hand.",
    ),
    "engaged": (
        "Engaged",
        "Share of the time for which the engagement model was on in which a visitor was engaged.",
    ),
    "episodes": ("Episodes", "Unbroken times of engagement, and how long they lasted."),
    "stops": ("Stops", "How often the stop latched, whoever caused it."),
    "trials": ("Trials", "Trials that were begun and are neither aborted nor excluded."),
    "percentile": (
        "Median and p95",
        "Half, and 95 of 100, of the values are at most this (linear between neighbours).",
    ),
}


def defined(name: str, text: str = "") -> Markup:
    """The figure's title, leading to its definition."""
    title, meaning = DEFINITIONS[name]
    return tag("a", text or title, href=f"#about-{name}", title=meaning, class_="defined")


def glossary() -> Markup:
    """All definitions."""
    entries = [
        (tag("dt", title, id=f"about-{name}"), tag("dd", meaning))
        for name, (title, meaning) in DEFINITIONS.items()
    ]
    return tag(
        "section",
        tag("h2", "What the figures mean", id="figures"),
        tag(
            "p",
            "Figures leave out what happened in trials that were aborted or excluded, unless all "
            "trials were asked for; timelines and lists of events show everything.",
        ),
        tag("dl", *entries, class_="glossary"),
        class_="figures",
        aria_labelledby="figures",
    )
