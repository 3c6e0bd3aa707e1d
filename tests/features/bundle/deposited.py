"""A study of simulated participants to deposit, with names planted wherever people have words."""

from __future__ import annotations

from operator import itemgetter
from pathlib import Path

from tests.export.logs import Timed, speak, start, write
from woz_tui.config.about_file import NOTHING, About
from woz_tui.export.log_sources import find_sources
from woz_tui.features.bundle.bundle import BundleOptions, BundleResult, write_bundle
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.protocol import messages as m
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.welcome import (
    DesignView,
    ItemLabel,
    Questionnaire,
    QuestionnaireItem,
    StudySettings,
    WelcomeSettings,
)

NAME = "Anna Keller-Winter"
INCOME = 4711471147
EXPERIMENT = """\
title: Warm or sober
robot: robots/simulated.yaml
participants: {pattern: "P\\\\d\\\\d"}   # P01 ... P99
conditions: [warm, sober]
panels:
  - {title: Speech, actions: [{key: h, label: Hello, say: "Hello. The tour begins now."}]}
"""
ENDS = ("not at all", "very much")
UX = Questionnaire(
    name="robot-ux",
    title="How was the robot?",
    when="condition",
    items=(
        QuestionnaireItem("pleasant", "I enjoyed being with this robot.", ends=ENDS),
        QuestionnaireItem("clear", "I knew what it wanted, always.", ends=ENDS),
        QuestionnaireItem("words", "What would you tell a friend?", text=True),
        QuestionnaireItem("page", "Only two more.", kind="page"),
        QuestionnaireItem(
            "robots",
            "Have you met robots?",
            kind="choice",
            choices=(ItemLabel(1, "never"), ItemLabel(2, "once")),
        ),
        QuestionnaireItem(
            "income", "What do you earn?", kind="number", high=9999999999, private=True
        ),
    ),
)
END = Questionnaire(
    name="end",
    title="To finish",
    items=(
        QuestionnaireItem(
            "person", "Was a person behind it?", low=1, high=5, ends=("never", "all the time")
        ),
    ),
)
#: By participant: the order, the answers to `pleasant`, that to `person`.
ANSWERS = {
    "P01": (("warm", "sober"), {"warm": 6, "sober": 3}, 2),
    "P02": (("sober", "warm"), {"warm": 4, "sober": 4}, 3),
    "P03": (("warm", "sober"), {"warm": 7, "sober": 2}, 2),
}
_SAY: dict[str, Json] = {"text": "Hello. The tour begins now."}


def plan(*asked: Questionnaire) -> m.SessionPlan:
    """What the console was shown."""
    study = StudySettings(
        design=DesignView("latin-square", True, 1),
        blind={"warm": "Lemon", "sober": "Orange"},
        questionnaires=[*asked] or [UX, END],
    )
    return m.SessionPlan(
        title="Warm or sober", panels=[], script=[], verbs={"robot": ["say"]}, variables=[],
        conditions=["warm", "sober"], keyboard="us", drivers=["robot"], simulated=["robot"],
        settings=WelcomeSettings(study=study),
    )  # fmt: skip


def _asked(at: float, which: Questionnaire, values: list[int | str], trial: int) -> list[Timed]:
    items: list[dict[str, Json]] = [
        {"name": i.name, "question": i.question, "low": i.low, "high": i.high, "ends": [*i.ends]}
        if not i.text
        else {"name": i.name, "question": i.question, "text": True}
        for i in which.items
    ]
    course: list[Timed] = [
        (
            at,
            QuestionnaireStarted(
                questionnaire=which.name, title=which.title, items=items, trial=trial
            ),
        )
    ]
    for item, value in zip((i for i in which.items if i.kind != "page"), values, strict=True):
        said = {"text": value} if isinstance(value, str) else {"value": float(value)}
        course.append(
            (
                at + 1,
                QuestionnaireAnswered(
                    questionnaire=which.name, item=item.name, question=item.question,
                    answered_us=1_000_000, private=item.private, **said,
                ),
            )
        )  # fmt: skip
    ended = QuestionnaireEnded(questionnaire=which.name, reason="done", answered=len(values))
    return [*course, (at + 2, ended)]


def course_of(
    who: str, experiment: str = EXPERIMENT, ux: Questionnaire = UX, changed: Questionnaire = UX
) -> list[Timed]:
    """The session of one participant: both conditions, and words of people everywhere. `ux` is
    asked after the first one, and what it was `changed` to after the second.
    """
    order, pleasant, person = ANSWERS[who]
    course: list[Timed] = [
        (0, start(who, f"S{who[1:]}", condition="", experiment="study.yaml")),
        (
            0,
            m.ExperimentFiles(
                experiment_sha256="ab" * 32,
                files={
                    "study.yaml": experiment,
                    "robots/simulated.yaml": "drivers: {robot: {type: simulated}}\n",
                },
            ),
        ),
        (0.1, plan(ux, END)),
        *([(100, plan(changed, END))] if changed != ux else []),
        (0.2, m.Note(text=f"{NAME} has come")),
    ]
    for place, condition in enumerate(order):
        at = 10.0 + 100 * place
        run, command = f"a{place}", f"c{place}"
        course += [
            (at, m.TrialStarted(trial=place + 1, condition=condition)),
            (at + 1, m.SpeechStarted(driver="ears", segment=place + 1, began=_us(at + 1))),
            (
                at + 2,
                m.SpeechEnded(
                    driver="ears",
                    segment=place + 1,
                    began=_us(at + 1),
                    ended=_us(at + 2),
                    file=f"speech/{NAME}.wav",
                ),
            ),
            (at + 2.5, m.SpeechText(driver="ears", segment=place + 1, text=f"I am {NAME}.")),
            (at + 4, m.ActionRequested(run=run, action="Hello", panel="Speech", source="key")),
            (at + 4, m.Command(command=command, run=run, verb="say", args=_SAY, source="key")),
            (at + 4, m.Dispatched(command=command, driver="robot", latency_us=1000)),
            (at + 5, m.Done(command=command, sent=_SAY, latency_us=1000, duration_us=1_000_000)),
            (at + 5, m.ActionDone(run=run, action="Hello")),
            (at + 5.5, m.Mistake(run=run, action="Hello", text=f"too late for {NAME}")),
            (at + 6, m.Marker(text=f"{NAME}, smiling")),
            (at + 60, m.TrialEnded(trial=place + 1, outcome="done", text=f"{NAME} was happy")),
        ]
        answers: list[int | str] = [pleasant[condition], 5, f"{NAME} liked it", 2, INCOME]
        course += _asked(at + 61, changed if place else ux, answers, place + 1)
    return sorted([*course, *_asked(300, END, [person], -1)], key=itemgetter(0))


def _us(seconds: float) -> int:
    return round(seconds * 1_000_000)


def recorded(folder: Path, *, last: str = EXPERIMENT) -> Path:
    """The logs of all; `last`: the experiment file as the last one was played."""
    for day, who in enumerate(ANSWERS, 1):
        stem = f"2026-03-{day:02}T10-00-00_{who}_S{who[1:]}"
        write(folder, course_of(who, last if who == "P03" else EXPERIMENT), stem)
        speak(folder / f"{stem}.media", f"{NAME}.wav", 0.1)
    return folder


def bundled(
    recordings: Path, out: Path, about: About = NOTHING, *, force: bool = False, **options: object
) -> BundleResult:
    """A bundle of the study."""
    sources, _ = find_sources([recordings])
    given = BundleOptions(about=about, **options)  # type: ignore[arg-type]
    return write_bundle(sources, out, given, force=force)
