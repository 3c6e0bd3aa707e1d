"""The criteria for reporting studies with a wizard, each with its answer and where that is from:
L. D. Riek, Wizard of Oz Studies in HRI, Journal of Human-Robot Interaction 1 (1), 2012.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from woz_tui.analysis.methods_section import Paragraph
from woz_tui.config.about_file import About
from woz_tui.protocol import messages as m
from woz_tui.system.text_cleaning import cell

LOG, FILE, ABOUT, MISSING = "log", "experiment file", "about.yaml", "missing"
_HEADS = ("criterion", "answer", "source")


@dataclass(frozen=True, slots=True)
class Criterion:
    """One criterion; `source` is `LOG`, `FILE`, `ABOUT`, several of them, or `MISSING`."""

    name: str
    answer: str
    source: str

    @property
    def is_missing(self) -> bool:
        """Whether nobody has answered it."""
        return self.source == MISSING


def criteria(
    found: Sequence[Paragraph], about: About, plan: m.SessionPlan | None
) -> list[Criterion]:
    """All of them, in the order of the guidelines."""
    told = {each.head: " ".join(each.sentences) for each in found}
    answers: Mapping[str, Sequence[tuple[str, str]]] = {
        "Robot: what it is": [(about.robot, ABOUT), (_of(found, "Robot", ("simulated",)), LOG)],
        "Robot: how autonomous it was": [(_share(found), LOG), (about.technology, ABOUT)],
        "Users: how many": [(_of(found, "Participants and sessions", ("participant",)), LOG)],
        "Users: who, how found and paid": [(about.participants, ABOUT)],
        "Users: what they were told and expected": [(about.instructions, ABOUT)],
        "Users: hypotheses on their behaviour": [(about.hypotheses, ABOUT)],
        "Users: whether the simulation convinced them": [
            (told.get("Suspicion", ""), LOG),
            (about.debriefing, ABOUT),
        ],
        "Wizards: how many": [(told.get("Wizards", ""), LOG)],
        "Wizards: who, and what they knew": [(about.wizards, ABOUT), (_blind(plan), FILE)],
        "Wizards: training": [
            (_of(found, "Wizards", ("raining", "practised")), LOG),
            (about.training, ABOUT),
        ],
        "Wizards: what they could produce": [(told.get("Wizard production", ""), LOG)],
        "Wizards: what they could recognise": [(told.get("Wizard recognition", ""), LOG)],
        "Wizards: errors": [(_of(found, "Errors and times", ("mistake", "cue")), LOG)],
        "Wizards: times": [(_of(found, "Errors and times", ("time",)), LOG)],
        "General: where": [(about.place, ABOUT)],
        "General: scenario": [(about.scenario, ABOUT)],
        "General: what the wizard stood for": [(about.technology, ABOUT)],
        "General: whether the design was iterative": [(about.iterative, ABOUT)],
        "General: what the method leaves open": [(about.limitations, ABOUT)],
        "General: approval": [
            (", ".join(filter(None, (about.ethics.board, about.ethics.number))), ABOUT)
        ],
    }
    return [_criterion(name, parts) for name, parts in answers.items()]


def _criterion(name: str, parts: Iterable[tuple[str, str]]) -> Criterion:
    said = [(text, source) for text, source in parts if text]
    sources = dict.fromkeys(source for _, source in said)
    return Criterion(name, " ".join(text for text, _ in said), ", ".join(sources) or MISSING)


def _of(found: Iterable[Paragraph], head: str, words: Sequence[str]) -> str:
    """Those sentences of a paragraph that speak of one of these."""
    return " ".join(
        sentence
        for each in found
        if each.head == head
        for sentence in each.sentences
        if any(word in sentence for word in words)
    )


def _share(found: Iterable[Paragraph]) -> str:
    return _of(found, "Wizard production", ("asked for",))


def _blind(plan: m.SessionPlan | None) -> str:
    if plan is None or not plan.settings.study.blind:
        return ""
    return "The console showed other names for the conditions: the wizard was blind to them."


def as_csv(found: Iterable[Criterion]) -> str:
    """As a table for programs."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\r\n")
    writer.writerow(_HEADS)
    writer.writerows([cell(each.name), cell(each.answer), each.source] for each in found)
    return stream.getvalue()


def as_markdown(found: Iterable[Criterion]) -> str:
    """As a table to read."""
    return "\n".join(_lines(found)) + "\n"


def _lines(found: Iterable[Criterion]) -> Iterator[str]:
    yield "# Criteria for studies with a wizard"
    yield ""
    yield "After L. D. Riek, Wizard of Oz Studies in HRI, JHRI 1 (1), 2012."
    yield from ("", "| criterion | answer | source |", "|---|---|---|")
    for each in found:
        answer = " ".join(each.answer.split()).replace("|", "\\|")
        yield f"| {each.name} | {answer} | {each.source} |"
