"""Half an hour with a wizard who presses anything: everything has its end, and nothing is left."""

from __future__ import annotations

import asyncio
import contextlib
import random
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.fakes.virtual_time import run_virtual
from tests.features.questionnaires.rig import due, history, questionnaires, study_experiment
from tests.session.rig import SessionRig
from tests.session.study_rig import trial_control
from woz_tui.analysis.figure_counting import FigureOptions
from woz_tui.analysis.session_reading import read_report
from woz_tui.features.delay.kinds import ActionHeld
from woz_tui.features.delay.section import SHAPING, ResponseShaping
from woz_tui.features.questionnaires.kinds import (
    AskAnswer,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.gate.questions import RequestOrigin
from woz_tui.log.verify import verify
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.participant_identity import SessionIdentity

HALF_AN_HOUR = 1800.0
KEY = RequestOrigin("key", "h", "con1")
MODES = ("", "queue", "replace", "refuse")
OUTCOMES = ("begin", "begin", "done", "done", "aborted", "excluded", "break", "resume")


class RandomWizard:
    """Does one thing after the other, whatever it is; what is refused is refused."""

    def __init__(self, rig: SessionRig, seed: int) -> None:
        self.rig = rig
        self.chance = random.Random(seed)
        self.asked: list[str] = []
        self._deeds: tuple[tuple[int, Callable[[], object]], ...] = (
            (30, self._play),
            (8, self._speak),
            (8, self._cue),
            (4, lambda: self.rig.session.cancel(self.asked[-1])),
            (3, lambda: self.rig.session.stop("key")),
            (9, lambda: self.rig.session.release("key")),
            (10, lambda: trial_control(self.rig.session).trial(self.chance.choice(OUTCOMES), "")),
            (4, self._assign),
            (16, self._ask),
            (2, lambda: self.rig.session.lock("Base", self.chance.random() < 0.5)),
            (2, lambda: self.rig.session.mistake("", "slipped")),
            (1, lambda: self.rig.session.adopt(self.rig.session.experiment, ["nothing"])),
        )

    def act(self) -> None:
        """Something."""
        weights = [weight for weight, _ in self._deeds]
        ((_, deed),) = self.chance.choices(self._deeds, weights)
        with contextlib.suppress(RequestError, IndexError):
            deed()

    def _play(self) -> None:
        panels = self.rig.session.experiment.panels
        names = [action.name for panel in panels for action in panel.actions]
        mode = self.chance.choice(MODES)
        self.asked.append(self.rig.session.play(self.chance.choice(names), KEY, mode))

    def _speak(self) -> None:
        text: dict[str, m.Json] = {"text": f"typed {self.chance.random()}"}
        mode = self.chance.choice(MODES)
        self.asked.append(self.rig.session.send("say", text, "", KEY, when_busy=mode))

    def _cue(self) -> None:
        now = self.rig.session.hub.now()
        self.rig.session.hub.publish(m.SpeechEnded(driver="robot", segment=1, began=now, ended=now))

    def _assign(self) -> None:
        participant = f"P{self.chance.randrange(100):02d}"
        order = ["warm", "cold"] if self.chance.random() < 0.5 else ["cold", "warm"]
        trial_control(self.rig.session).assign(participant, order)

    def _ask(self) -> None:
        current = history(self.rig).questionnaire
        if current is None or current.started is None:
            now = [each.questionnaire for each in due(self.rig)]
            questionnaires(self.rig).begin_or_end(
                self.chance.choice([*now, "whenever"]), "begin", "wizard"
            )
        elif self.chance.random() < 0.4:
            how = self.chance.choice(["done", "declined", "left"])
            questionnaires(self.rig).begin_or_end(current.name, how, "participant")
        else:
            item = self.chance.choice(current.started.items)
            text = "well" if item.get("text") else ""
            value = None if text else float(self.chance.randint(0, 6))
            questionnaires(self.rig).answer(
                AskAnswer(questionnaire=current.name, item=item["name"], value=value, text=text)
            )


async def _whole(tmp_path: Path, seed: int) -> SessionRig:
    loop = asyncio.get_running_loop()
    failed: list[object] = []
    loop.set_exception_handler(lambda loop, told: failed.append(told))
    shaping = ResponseShaping(0.8, 2.0, ("speech",))
    asked = study_experiment(tmp_path)
    made = replace(asked, sections={**asked.sections, SHAPING: shaping})
    rig = SessionRig(tmp_path, identity=SessionIdentity(seed=seed), made=made)
    async with rig:
        rig.session.bus.unwatched = ""
        wizard = RandomWizard(rig, seed)
        while loop.time() < HALF_AN_HOUR:
            await asyncio.sleep(wizard.chance.expovariate(1.0))
            wizard.act()
    await asyncio.sleep(1)
    assert failed == []
    assert asyncio.all_tasks() == {asyncio.current_task()}
    assert not [timer for timer in loop._scheduled if not timer.cancelled()]  # type: ignore[attr-defined]
    return rig


@pytest.mark.parametrize("seed", [1, 2])
def test_whatever_the_wizard_does_everything_has_its_end(tmp_path: Path, seed: int) -> None:
    rig = run_virtual(_whole(tmp_path, seed))
    lines = rig.lines
    held = [line for line in lines if isinstance(line, ActionHeld)]
    assert len(held) > 20
    last = {name: line.seq for line in lines if _goes_on(line) for name in _ids(line)}
    assert [line.run for line in held if last.get(line.run, -1) < line.seq] == []
    for begins, ends in (
        (m.TrialStarted, m.TrialEnded),
        (m.BreakStarted, m.BreakEnded),
        (QuestionnaireStarted, QuestionnaireEnded),
    ):
        course = [isinstance(each, begins) for each in lines if isinstance(each, (begins, ends))]
        assert course == [True, False] * (len(course) // 2)
        assert len(course) > 10
    verdict = verify(rig.recorder.path)
    assert verdict.sentences() == []
    assert verdict.lines == lines[-1].seq + 1
    ended = [each for each in lines if isinstance(each, m.ActionEnd)]
    assert (
        read_report(rig.recorder.path, FigureOptions(all_trials=True)).figures.whole.actions
        == len(ended)
        > 300
    )


def _goes_on(line: m.Message) -> bool:
    """Whether something that was held has begun with this, or has ended."""
    return isinstance(line, m.Command | m.ActionEnd | m.End)


def _ids(line: m.Message) -> set[str]:
    return {getattr(line, "run", ""), getattr(line, "command", "")}
