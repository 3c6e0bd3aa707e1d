"""A study from the wizard's terminal and the participant's own: order, trial, questionnaire."""

from __future__ import annotations

import pytest

from tests.e2e import scenes
from tests.e2e.lab import Lab
from tests.fakes.terminal import FakeTerminal

pytestmark = pytest.mark.real_clock

STUDY = """\
design: {order: latin-square, trials: 1, blind: {warm: Lemon, cold: Orange}}
questionnaires:
  - name: quick
    title: This visit
    when: trial
    items:
      - {name: pleasant, question: How pleasant was it?}
      - {name: again, question: How likely will you come again?, scale: {low: 0, high: 10}}
      - {name: else, question: Anything else?, text: true, optional: true}
preflight: [The consent form is signed]
"""
DOWN, ESCAPE, CTRL_Q, CTRL_R, CTRL_T = "\x1b[B", "\x1b", "\x11", "\x12", "\x14"


def participant(lab: Lab) -> FakeTerminal:
    terminal = lab.terminal(["attach", "--questionnaire"])
    terminal.wait_text("Please wait.")
    return terminal


def test_leaving_ends_the_trial_and_asks_its_questionnaire_first(lab: Lab) -> None:
    wizard = lab.run(lab.file("guide.yaml", scenes.guide() + STUDY))
    log = lab.log
    wizard.send(CTRL_T)
    wizard.wait_text("1. Lemon")
    wizard.send("\r")
    wizard.wait_for(lambda screen: "Participant ─" not in screen)
    wizard.send("*")
    wizard.wait_text("begin trial 1")
    wizard.send("b")
    wizard.wait_text("trial 1/2")
    wizard.send(CTRL_Q)
    wizard.wait_text("Trial 1 is still running")
    for _ in range(3):
        wizard.send(DOWN)
    wizard.send("\r")
    wizard.wait_text("This visit has not been answered: ask it first")
    wizard.send("\x1b[A\r")
    assert log.wait("questionnaire.started").fields["trial"] == 1
    assert log.wait("trial.ended").fields["outcome"] == "done"
    wizard.wait_text("3 questions.")
    assert log.lines("session.end") == []


@pytest.mark.safety
def test_a_trial_and_what_is_asked_after_it(lab: Lab) -> None:
    wizard = lab.run(lab.file("guide.yaml", scenes.guide() + STUDY))
    log = lab.log
    wizard.send(CTRL_T)
    wizard.wait_text("1. Lemon")
    wizard.send("\r")
    assert log.wait("condition.assigned").fields["order"] == ["warm", "cold"]
    guest = participant(lab)
    wizard.wait_text("participant attached")

    wizard.send("*")
    wizard.wait_text("begin trial 1")
    wizard.send("b")
    assert log.wait("trial.started").fields["condition"] == "warm"
    wizard.wait_text("trial 1/2")
    wizard.send("*")
    wizard.wait_text("this trial is over")
    wizard.send("d")
    log.wait("trial.ended", outcome="done")
    wizard.wait_text("At the participant's terminal")
    wizard.send(DOWN)  # behind reading it aloud and turning the screen round
    wizard.send(DOWN)
    wizard.send("\r")
    log.wait("questionnaire.started", questionnaire="quick")

    guest.wait_text("3 questions.")
    guest.send("\r")
    guest.wait_text("How pleasant was it?")
    guest.send("6")
    assert log.wait("questionnaire.answered").fields["value"] == 6
    wizard.wait_text("questions 1/3")
    for chord in ("h", CTRL_R, "\x1a", "."):  # nothing of the wizard's
        guest.send(chord)
    guest.send(ESCAPE)
    assert log.wait("stop.pressed").fields["source"] == "the participant"
    wizard.wait_text("STOPPED by the participant")
    guest.wait_text("The robot has been stopped.")
    wizard.send(CTRL_R)
    log.wait("stop.released")
    wizard.send("h")
    log.wait("action.done", action="Hello")
    guest.wait_text("How likely will you come again?")
    for keys in ("1", "0", "\r"):
        guest.send(keys)
    guest.wait_text("Anything else?")
    guest.send("h and more")
    guest.wait_text("h and more")
    guest.send("\r")
    guest.wait_text("finish")
    guest.send(DOWN)  # so that the next enter cannot be the last one, held
    guest.send("\r")
    guest.wait_text("Thank you!")
    log_line = log.wait("questionnaire.ended")
    assert (log_line.fields["reason"], log_line.fields["answered"]) == ("done", 3)
    answers = [line.fields for line in log.lines("questionnaire.answered")]
    assert [(each["item"], each.get("value"), each.get("text", "")) for each in answers] == [
        ("pleasant", 6, ""),
        ("again", 10, ""),
        ("else", None, "h and more"),
    ]
    assert len(log.lines("action.requested")) == 1
    assert not log.lines("marker")
    for secret in ("warm", "cold"):
        assert secret not in wizard.text
    guest.send(CTRL_Q)
    assert guest.wait_exit() == 0
    assert wizard.text


def test_the_terminal_outlives_the_robot_process(lab: Lab) -> None:
    host = lab.host(lab.file("guide.yaml", scenes.guide() + STUDY))
    guest = participant(lab)
    host.kill()
    guest.wait_text("Just a moment, please.")
    guest.send(CTRL_Q)
    assert guest.wait_exit() == 0
