"""A whole study in terminals: wizard and participants press keys until its logs are there.

`python -m tests.e2e.played_study FOLDER 24` plays it with 24 simulated participants, half a minute
each; a third argument is the first one, to go on after an interruption. What they answer is decided
by their codes, and compared with each line of the log.
"""

from __future__ import annotations

import random
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tests.e2e.lab import Lab, Log, end_session, until
from tests.fakes.terminal import FakeTerminal

STUDY = """\
title: Warm or sober
robot: simulated
participants: {pattern: "P\\\\d\\\\d"}            # P01 ... P99
conditions: [warm, sober]
variables:
  hello: {warm: "Hello, dear!", sober: "Hello."}
  bye: {warm: "Come back soon!", sober: "Goodbye."}
design: {order: latin-square, trials: 1, seed: 11, blind: {warm: Lemon, sober: Orange}}
questionnaires:
  - name: before
    title: Before we begin
    when: start
    items:
      - {name: age, question: "How old are you?", number: {low: 18, high: 99, unit: years}, prefer_not: prefer not to say}
      - {name: known, question: "Have you talked to a robot before?", choices: ["yes", "no", unsure]}
      - {name: which, question: "Which ones?", choices: [Pepper, NAO], several: true, other: true, if: {item: known, is: ["yes", unsure]}}
      - {name: since, question: "Since when?", month: true, if: {item: known, is: "yes"}}
      - {name: hopes, question: "What do you hope for?", text: true, optional: true}
  - {file: lab/tlx.yaml, when: condition}
  - {file: lab/sus-adapted.yaml, when: condition}
  - name: impression
    title: The robot
    when: condition
    order: shuffled
    scale: {low: 1, high: 7, show: none, stored: {low: -3}}
    stem: The robot was
    items:
      - {page: "Please think of the last conversation only."}
      - {name: natural, between: [fake, natural], flip: shuffled}
      - {name: tense, between: [relaxed, uneasy], flip: shuffled, reverse: true}
      - {name: kind, between: [unfriendly, friendly], does_not_apply: I cannot say}
    scores:
      warmth: {items: [natural, tense, kind], how: mean, missing: 1}
  - {file: lab/suspicion.yaml, when: end}
panels:
  - title: Speech
    actions:
      - {key: h, label: Hello, say: "{hello}"}
      - {key: b, label: Bye, say: "{bye}"}
      - {key: n, label: Nod, play: nod}
"""  # noqa: E501
INSTRUMENTS = ("tlx", "sus-adapted", "suspicion")
ORDER = ("before", "tlx", "sus-adapted", "impression", "suspicion")
#: What some do besides.
DECLINES, ABORTS, EXCLUDED, STOPS = "P05", "P07", "P09", "P11"
DOWN, UP, HOME, RIGHT, TAB = "\x1b[B", "\x1b[A", "\x1b[H", "\x1b[C", "\t"
ENTER, CTRL_D, CTRL_Q, CTRL_R, CTRL_T = "\r", "\x04", "\x11", "\x12", "\x14"
#: Nobody has read a question sooner: the same digit that comes before is taken for a held key.
READING_S = 0.85
WORDS = ("It was nice, I think", "The robot chose by itself", 'a "study", of voices; quite')

#: An answer: its number, its words, codes of choices, or why there is none.
Answer = dict[str, Any]


@dataclass
class Participant:
    """Somebody who answers. `answers`: what was answered, by round of a questionnaire."""

    code: str
    condition: str = ""
    answers: dict[tuple[str, str, str], Answer] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._chance = random.Random(self.code)
        self.number = int(self.code[1:])

    def given(self) -> str:
        """Where they answer."""
        return ("self", "read_aloud", "own_terminal")[self.number % 3]

    def decide(self, item: Mapping[str, Any]) -> Answer:
        """What to answer; numbers are those that are stored."""
        chance, warm = self._chance, self.condition == "warm"
        kind = "text" if item.get("text") else item.get("kind", "scale")
        if kind == "text":
            skipped = item.get("optional") and chance.random() < 0.5
            return {"reason": "skipped"} if skipped else {"text": chance.choice(WORDS)}
        if kind == "month":
            return {"text": f"20{chance.randint(10, 26)}-0{chance.randint(1, 9)}"}
        if kind == "number":
            return (
                {"reason": "prefer_not"}
                if self.number % 6 == 4
                else {"value": chance.randint(18, 80)}
            )
        if kind == "choice":
            return {"value": chance.choice(item["choices"])["value"]}
        if kind == "choices":
            codes = [each["value"] for each in item["choices"]]
            ticked = sorted(chance.sample(codes, chance.randint(1, len(codes))))
            return {
                "ticked": ticked,
                **({"text": "=Furhat"} if item.get("other") in ticked else {}),
            }
        if item.get("does_not_apply") and self.number % 8 == 2 and warm:
            return {"reason": "does_not_apply"}
        low, high, step = item["low"], item["high"], item.get("step", 1)
        points = (high - low) // step
        place = round(points * min(0.99, max(0.01, chance.gauss(0.62 if warm else 0.45, 0.22))))
        return {"value": low + place * step}


class StudyPlayer:
    """One session: the wizard's terminal, and the participant's if they have one."""

    def __init__(self, lab: Lab, experiment: Path, participant: Participant) -> None:
        self.participant = participant
        #: When a digit answered at once.
        self._answered_s = 0.0
        self._last_key = ""
        words = ("--recordings", str(lab.recordings), "--participant", participant.code)
        self.wizard = lab.terminal(["run", str(experiment), *words])
        self.wizard.wait_text("Recording")
        self.log: Log = until(lambda: _log_of(lab, participant.code), "the log of the session")
        self.log.wait("session.plan")
        own = participant.given() == "own_terminal"
        self.guest = lab.terminal(["attach", "--questionnaire"]) if own else None
        if self.guest is not None:
            self.guest.wait_text("Please wait.")
            self.wizard.wait_text("participant attached")

    def play(self) -> None:
        """The whole session."""
        self.wizard.send(CTRL_T)
        self.wizard.wait_text("Proposed")
        self.wizard.send(ENTER)
        order = self.log.wait("condition.assigned").fields["order"]
        self.wizard.wait_for(lambda screen: "Participant ─" not in screen)
        self._ask("before")
        for number, condition in enumerate(order, start=1):
            self._trial(number, condition)
            self.participant.condition = condition
            for name in ORDER[1:4]:
                self._ask(name)
        self.participant.condition = ""
        self._ask("suspicion")
        if self.guest is not None:
            self.guest.send(CTRL_Q)
            self.guest.wait_exit()
        self._wizards_screen()
        end_session(self.wizard)
        self.wizard.wait_exit()

    # -- the wizard ---------------------------------------------------------------------------

    def _wizards_screen(self) -> None:
        self.wizard.wait_text("Events ─")

    def _trial(self, number: int, condition: str) -> None:
        code, ended = self.participant.code, "done"
        if number == 2 and code in (ABORTS, EXCLUDED):
            ended = "aborted" if code == ABORTS else "excluded"
            self._begin(number, condition)
            self._step(ended[1] if ended == "excluded" else "a", f"{ended}:")
            self.wizard.wait_text("reason (optional)")
            self.wizard.send("Anna Keller coughed")
            self.wizard.wait_text("Anna Keller coughed")
            self.wizard.send(ENTER)
            self.log.wait("trial.ended", outcome=ended)
        if ended != "excluded":
            self._begin(number, condition)
            self._step("d", "this trial is over")
            self.log.wait("trial.ended", count=number, outcome="done")

    def _begin(self, number: int, condition: str) -> None:
        count = len(self.log.lines("trial.started")) + 1
        self._step("b", f"begin trial {number}")
        assert self.log.wait("trial.started", count).fields["condition"] == condition
        self.wizard.wait_text("trial ")
        for key, action in (("h", "Hello"), ("n", "Nod"), ("b", "Bye")):
            count = len(self.log.lines("action.done", action=action)) + 1
            self.wizard.send(key)
            self.log.wait("action.done", count, action=action)
        if self.participant.code == STOPS:
            self.wizard.send("\x1b")
            self.wizard.wait_text("STOPPED")
            self.wizard.send(CTRL_R)
            self.log.wait("stop.released", len(self.log.lines("stop.pressed")))

    def _step(self, key: str, text: str) -> None:
        """A key of the dialog of trials."""
        self._wizards_screen()
        self.wizard.send("*")
        self.wizard.wait_text(text)
        self.wizard.send(key)
        self.wizard.wait_for(lambda screen: "─ Trial ─" not in screen or "reason (opt" in screen)

    # -- questionnaires -----------------------------------------------------------------------

    def _ask(self, name: str) -> None:
        """Choose where it is asked, and have it answered."""
        if "I read it aloud" not in self.wizard.text:
            self._offer()
        self.wizard.wait_text("I read it aloud")
        given = self.participant.given()
        for _ in range(("read_aloud", "self", "own_terminal").index(given)):
            self.wizard.send(DOWN)
        self.wizard.send(ENTER)
        if name == "suspicion":
            self.wizard.wait_text("In which language?")
            self.wizard.send(ENTER)
        begun = self.log.wait(
            "questionnaire.started", len(self.log.lines("questionnaire.ended")) + 1
        )
        assert begun.fields["questionnaire"] == name
        screen = self.guest or self.wizard
        if self.guest is not None:  # who answers is never as quick as this
            self.wizard.wait_text(" questions ")
        self._answer(screen, begun.fields)
        screen.wait_text("Thank you!")
        self.log.wait("questionnaire.ended", len(self.log.lines("questionnaire.started")))
        if self.guest is not None:
            self.wizard.wait_for(lambda screen: "questions " not in screen)
        else:
            self.wizard.send(CTRL_Q)
            self.wizard.wait_for(lambda screen: "Thank you!" not in screen)

    def _offer(self) -> None:
        """It comes by itself behind a trial, and behind another one on this screen."""
        comes = self.log.lines()[-1].kind == "trial.ended" or self.guest is None
        if comes and len(self.log.lines("questionnaire.ended")):
            self.wizard.wait_text("I read it aloud")
            return
        self._step("q", "q   ask: ")

    def _answer(self, screen: FakeTerminal, begun: Mapping[str, Any]) -> None:
        who, name = self.participant, begun["questionnaire"]
        screen.wait_text("enter begins")
        if who.code == DECLINES and name == "sus-adapted" and who.condition == "sober":
            screen.send(CTRL_D)
            screen.wait_text("Stop here")
            screen.send("y")
            return
        screen.send(ENTER)
        answers: dict[str, Answer] = {}
        for item in begun["items"]:
            if item.get("kind") == "page":
                screen.wait_text(item["question"])
                screen.send(RIGHT)
            elif _is_asked(item, answers):
                count = len(self.log.lines("questionnaire.answered")) + 1
                answers[item["name"]] = answer = who.decide(item)
                who.answers[name, who.condition, item["name"]] = answer
                self._press(screen, item, answer)
                self._press_again(screen, count)
                told = self.log.wait("questionnaire.answered", count).fields
                assert told["item"] == item["name"], told
                assert _said(told) == answer, told
        screen.wait_text("finish")
        screen.send(DOWN)  # so that the next enter cannot be the last one, held
        self._send_read(screen, ENTER)

    def _press(self, screen: FakeTerminal, item: Mapping[str, Any], answer: Answer) -> None:
        """The keys of an answer, as soon as the question stands there."""
        parts = [item["question"][:40]] if item.get("question") else item["ends"]
        screen.wait_for(lambda text: all(part in text for part in parts))
        if "reason" in answer:
            screen.send(TAB)
            return
        kind = "text" if item.get("text") else item.get("kind", "scale")
        if kind in ("text", "month"):
            self._type(screen, answer["text"])
        elif kind == "number":
            self._type(screen, str(answer["value"]))
        elif kind == "choice":
            place = [each["value"] for each in item["choices"]].index(answer["value"])
            self._digit(screen, str(place + 1))
        elif kind == "choices":
            for place, each in enumerate(item["choices"]):
                if each["value"] in answer["ticked"]:
                    self._send_read(screen, str(place + 1))
                    screen.wait_text(f"{place + 1}  [x]")
            screen.send(ENTER)
            if "text" in answer:
                screen.wait_text("Please say which:")
                self._type(screen, answer["text"])
        else:
            self._mark(screen, item, answer["value"])

    def _mark(self, screen: FakeTerminal, item: Mapping[str, Any], value: int) -> None:
        """A point, found by what stands at the ends of the scale."""
        low, high, step = item["low"], item["high"], item.get("step", 1)
        place, points = (value - low) // step, (high - low) // step
        text = screen.text
        if item.get("flip") and text.index(item["ends"][0]) > text.index(item["ends"][1]):
            place = points - place
        if item.get("kind") == "slider" and self.participant.number % 2:
            self._type(screen, str(low + place * step))
        elif points < 10 and low >= 0 and self.participant.number % 2:
            self._digit(screen, str(low + item.get("shift", 0) + place))
        else:
            screen.send(HOME + RIGHT * place)
            self._send_read(screen, ENTER)

    def _type(self, screen: FakeTerminal, text: str) -> None:
        screen.send(text)
        screen.wait_text(text)
        self._send_read(screen, ENTER)

    def _send_read(self, screen: FakeTerminal, key: str) -> None:
        """Send a key once the question has been read, if the key before answered at once."""
        until(lambda: time.monotonic() > self._answered_s + READING_S, "the question read")
        self._last_key = key
        screen.send(key)

    def _press_again(self, screen: FakeTerminal, count: int) -> None:
        """A busy machine may take two presses of a key for one that is held, and says so."""

        def taken() -> bool:
            return len(self.log.lines("questionnaire.answered")) >= count

        until(lambda: taken() or "Press again" in screen.text, "the answer")
        while not taken():
            self._answered_s = time.monotonic()
            self._send_read(screen, self._last_key)
            screen.wait_for(lambda text: "Press again" not in text)
            until(lambda: taken() or "Press again" in screen.text, "the answer")

    def _digit(self, screen: FakeTerminal, digit: str) -> None:
        """One that answers at once."""
        self._send_read(screen, digit)
        self._answered_s = time.monotonic()


def _is_asked(item: Mapping[str, Any], answers: Mapping[str, Answer]) -> bool:
    rule = item.get("only_if")
    return not rule or answers.get(rule["item"], {}).get("value") in rule["values"]


def _said(told: Mapping[str, Any]) -> Answer:
    """What a line of the log says that was answered."""
    if told.get("skipped"):
        return {"reason": told.get("reason") or "skipped"}
    found: Answer = {}
    if told.get("value") is not None:
        found["value"] = round(told["value"])
    if told.get("ticked"):
        found["ticked"] = told["ticked"]
    return {**found, **({"text": told["text"]} if told.get("text") else {})}


def _log_of(lab: Lab, code: str) -> Log | None:
    if not lab.recordings.is_dir():
        return None
    found = [
        path
        for path in lab.recordings.glob(f"*_{code}_*.jsonl")
        if ".samples" not in path.name and ".index" not in path.name
    ]
    return Log(found[0]) if found else None


def play(lab: Lab, codes: Sequence[str]) -> Iterator[Participant]:
    """The sessions of these participants, one after the other, in the lab's recordings."""
    experiment = lab.file("study.yaml", STUDY)
    for name in INSTRUMENTS:
        copied = lab.folder / "lab" / f"{name}.yaml"
        new = ["new", "--questionnaire", name, str(copied)]
        subprocess.run([sys.executable, "-m", "woz_tui", *new], check=True, capture_output=True)
    for code in codes:
        participant = Participant(code)
        player = StudyPlayer(lab, experiment, participant)
        try:
            player.play()
        except AssertionError:
            for screen in filter(None, (player.wizard, player.guest)):
                print(screen.text, file=sys.stderr)  # noqa: T201
            raise
        yield participant


def main() -> None:
    """Play it, and copy its files to a folder."""
    folder, count, first = Path(sys.argv[1]), int(sys.argv[2]), int((*sys.argv, "1")[3])
    with Lab() as lab:
        for each in play(lab, [f"P{number:02}" for number in range(first, count + 1)]):
            print(each.code, len(each.answers), flush=True)  # noqa: T201
            shutil.copytree(lab.folder, folder, dirs_exist_ok=True, ignore=_sockets)


def _sockets(folder: str, names: Sequence[str]) -> set[str]:
    return {name for name in names if name in ("run", "state", "config")}


if __name__ == "__main__":
    main()
