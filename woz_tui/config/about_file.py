"""`about.yaml`: what no log can know of a study, said once, for what is deposited and published.

title: Warm or sober
authors:
  - {name: Ada Example, orcid: 0000-0002-1825-0097, affiliation: University of Examples}
licence: CC-BY-4.0
ethics: {board: Ethics board of the university, number: 2026-17}
technology: speech recognition and a dialogue manager
retention: {media: 30 d, logs: 10 y}

Everything may be left out: what is missing is listed, never guessed.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, fields
from datetime import date, timedelta
from pathlib import Path
from typing import Annotated

from woz_tui.config.annotated_decoder import fields_of, read_settings
from woz_tui.config.problems import ProblemReport
from woz_tui.config.yaml_cursor import document, source_of
from woz_tui.drivers.fields import Doc, Entry, NotBlank, OneOf, Pattern

#: What participants can agree to besides what is shared of everybody.
SHARED = ("media", "transcripts")
#: Days of the units of a time for which something is kept.
_DAYS = {"d": 1, "w": 7, "y": 365.25}
_KEPT = re.compile(r"(\d{1,4}) ?([dwy])")

_Text = Annotated[str, NotBlank()]
_Time = Annotated[str, Pattern(_KEPT.pattern, "a number of days, weeks or years: 30 d, 6 w, 10 y")]
_Link = Annotated[str, Pattern(r"https?://\S+", "an address: https://...")]


@dataclass(frozen=True, slots=True)
class AuthorEntry(Entry):
    """Somebody who made the data."""

    what = "an author"
    example = "{name: Ada Example, affiliation: ...}"
    name: Annotated[str, NotBlank(), Doc("given name and family name, in this order")]
    orcid: Annotated[
        str,
        Pattern(r"\d{4}-\d{4}-\d{4}-\d{3}[\dX]", "an ORCID such as 0000-0002-1825-0097"),
        Doc("ORCID"),
    ] = ""
    affiliation: Annotated[_Text, Doc("where they work")] = ""


@dataclass(frozen=True, slots=True)
class EthicsEntry(Entry):
    """Who has approved the study."""

    what = "an approval"
    example = "{board: ..., number: ...}"
    board: Annotated[_Text, Doc("who approved it")] = ""
    number: Annotated[_Text, Doc("under which number")] = ""


@dataclass(frozen=True, slots=True)
class RetentionEntry(Entry):
    """For how long data are kept from the day on which they were recorded; nothing is deleted by
    the program.
    """

    what = "times"
    example = "{media: 30 d, logs: 10 y}"
    media: Annotated[_Time, Doc("sound and pictures")] = ""
    logs: Annotated[_Time, Doc("logs with what belongs to them")] = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class About(Entry):
    """The whole file."""

    what = "what is known of the study"
    example = "title: ..."
    title: Annotated[_Text, Doc("title of the data set")] = ""
    authors: Annotated[tuple[AuthorEntry, ...], Doc("who made the data")] = ()
    description: Annotated[_Text, Doc("what the data are about, in some sentences")] = ""
    licence: Annotated[
        str,
        Pattern(r"[A-Za-z0-9][A-Za-z0-9.+-]*", "a licence's short name, such as CC-BY-4.0"),
        Doc("licence of the data, by its SPDX name"),
    ] = ""
    contact: Annotated[_Text, Doc("whom to ask")] = ""
    funding: Annotated[_Text, Doc("who paid for it, with the number of the grant")] = ""
    ethics: Annotated[EthicsEntry, Doc("who approved it")] = EthicsEntry()
    share: Annotated[
        tuple[Annotated[str, OneOf(SHARED)], ...],
        Doc("what participants agreed to share besides redacted logs and their tables"),
    ] = ()
    keywords: Annotated[tuple[str, ...], Doc("words by which it is found")] = ()
    language: Annotated[_Text, Doc("language of the sessions")] = ""
    place: Annotated[_Text, Doc("where it took place")] = ""
    dates: Annotated[_Text, Doc("when it took place, as precisely as may be known")] = ""
    identifier: Annotated[_Text, Doc("DOI of the data set")] = ""
    preregistration: Annotated[_Link, Doc("address of the preregistration")] = ""
    article: Annotated[_Text, Doc("what to cite besides: DOI or address")] = ""
    robot: Annotated[_Text, Doc("what the robot is, and how autonomous it was")] = ""
    technology: Annotated[_Text, Doc("the technology that the wizard stood for")] = ""
    wizards: Annotated[_Text, Doc("who the wizards were, what they knew of the hypotheses")] = ""
    training: Annotated[_Text, Doc("what wizards had to reach before the first session")] = ""
    suspicion: Annotated[
        str,
        Pattern(
            r"[A-Za-z][\w-]*\.[A-Za-z][\w-]*", "a questionnaire and its item, such as end.person"
        ),
        Doc("the item that asks whether a wizard was suspected, if no questionnaire has that role"),
    ] = ""
    participants: Annotated[_Text, Doc("who they were, how they were found and paid")] = ""
    instructions: Annotated[_Text, Doc("what participants were told, and expected")] = ""
    debriefing: Annotated[_Text, Doc("when and how they were told of the wizard")] = ""
    hypotheses: Annotated[_Text, Doc("hypotheses, with their direction")] = ""
    scenario: Annotated[_Text, Doc("the scenario in words")] = ""
    iterative: Annotated[_Text, Doc("what was changed between rounds, or that nothing was")] = ""
    limitations: Annotated[_Text, Doc("what the method leaves open")] = ""
    retention: Annotated[RetentionEntry, Doc("for how long data are kept")] = RetentionEntry()


NOTHING = About()
#: What nobody has to say.
_NEVER_MISSING = frozenset({"retention", "share", "suspicion"})


def read_about(path: Path) -> About:
    """What the file says.

    Raises:
        ExperimentError: Something is wrong with it; all problems, each with its place.
    """
    report = ProblemReport()
    source = source_of(path, report)
    root = None if source is None else document(source, report, "title, authors and the like")
    found = NOTHING if root is None else read_settings(root, About)
    report.raise_errors()
    assert isinstance(found, About)  # `raise_errors` has raised otherwise
    return found


def missing_in(about: About) -> list[tuple[str, str]]:
    """What is not said: the key and what it is for."""
    return [
        (each.name, each.doc)
        for each in fields_of(About)
        if not _is_said(getattr(about, each.name)) and each.name not in _NEVER_MISSING
    ]


def _is_said(value: object) -> bool:
    if isinstance(value, Entry):
        return any(getattr(value, each.name) for each in fields(value))  # type: ignore[arg-type]
    return bool(value)


def last_day(recorded: date, kept: str) -> date:
    """The last day on which something that was `recorded` then is kept so long (`30 d`)."""
    found = _KEPT.fullmatch(kept)
    if found is None:
        raise ValueError(f"{kept!r} is no time such as 30 d")
    return recorded + timedelta(days=round(int(found[1]) * _DAYS[found[2]]))
