"""What a driver says of commands that are only written: what it is asked, where it is told."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import pytest

from tests.config.catalogue import Bare
from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.config.problems import MAX_PROBLEMS
from woz_tui.drivers.contract import UNKNOWN, Argument, Ask, Driver, Finding, Offer, Verb, Written
from woz_tui.protocol.messages import Json


@dataclass(frozen=True, slots=True)
class NoSettings:
    """No setting at all."""


def without_pin(text: str) -> str:
    return text.replace("1234", "***")


VERBS = (
    Verb("say", "", (Argument("text", "text", required=True), Argument("loud", "number"))),
    Verb("read", "", (Argument("file", "file", required=True),)),
    Verb("enter", "", (Argument("pin", "text", required=True, hide=without_pin),)),
)


class Critic(Bare):
    """Finds what the text asks for: `warning`, `error`, `info` or `crash`."""

    Settings = NoSettings
    asked: ClassVar[list[tuple[str, Mapping[str, Json]]]] = []
    folders: ClassVar[set[Path]] = set()

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return Offer(verbs=VERBS)

    @classmethod
    def remarks(cls, settings: Any, written: Written) -> Iterator[Finding]:
        cls.asked.append((written.verb, written.args))
        cls.folders.add(written.folder)
        if written.verb == "read":
            yield Finding(
                "warning", "file", f"there is no file {written.args['file']!r}", "make one"
            )
        text = str(written.args.get("text", ""))
        if text == "crash":
            raise ZeroDivisionError("oops")
        if text in ("warning", "error", "info"):
            yield Finding(text, "text", f"this is {text}", "mend it")
        if written.args.get("loud") == 2.0:
            yield Finding("warning", "loud", "too loud")


CATALOGUE: Mapping[str, type[Driver]] = {"critic": Critic}
HEAD = """title: T
robot: {drivers: {it: {type: critic}}}
conditions: [warm, cold]
variables:
  name: Ada
  pin: is 1234
  hello: {warm: "Dear {name}", cold: "You, {participant}"}
"""


@pytest.fixture(autouse=True)
def afresh() -> None:
    Critic.asked.clear()
    Critic.folders.clear()


def read_experiment(folder: Path, actions: Iterable[str], more: str = "") -> Experiment:
    lines = "".join(f"  - {{label: L{n}, {action}}}\n" for n, action in enumerate(actions))
    path = folder / "e.yaml"
    path.write_text(f"{HEAD}{more}panels:\n- title: P\n  actions:\n{lines}", encoding="utf-8")
    return load(path, CATALOGUE)


def remarks_of(folder: Path, *actions: str, more: str = "") -> list[str]:
    """Errors, or if there are none warnings, without the file's name and line."""
    try:
        found = [*read_experiment(folder, actions, more).warnings]
    except ExperimentError as error:
        found = error.problems
    return [str(one).partition(".yaml:")[2].partition(":")[2] for one in found]


def test_it_is_asked_with_variables_filled_in_once_for_each_condition(tmp_path: Path) -> None:
    read_experiment(
        tmp_path, ["say: 'a {{b}} {name}'", "say: '{hello}!'", "say: '{wizard} {trial}', loud: 1"]
    )
    assert Critic.asked == [
        ("say", {"text": "a {b} Ada"}),
        ("say", {"text": "Dear Ada!"}),
        ("say", {"text": f"You, {UNKNOWN}!"}),
        ("say", {"text": f"{UNKNOWN} {UNKNOWN}", "loud": 1.0}),
    ]
    assert Critic.folders == {tmp_path}


def test_it_is_told_at_the_argument_and_lets_the_file_pass(tmp_path: Path) -> None:
    assert remarks_of(
        tmp_path,
        "say: warning",
        "say: {text: warning, loud: 2}",
        "steps: [{wait: 1}, {say: x, loud: 2}]",
        "say: info",
    ) == [
        "17: warning: P > L0 > say: this is warning; mend it",
        "23: warning: P > L1 > say.text: this is warning; mend it",
        "38: warning: P > L1 > say.loud: too loud",
        "45: warning: P > L2 > steps[1].loud: too loud",
    ]


def test_an_error_of_the_driver_refuses_the_file(tmp_path: Path) -> None:
    assert remarks_of(tmp_path, "say: error") == ["17: P > L0 > say: this is error; mend it"]


def test_a_variable_that_is_wrong_in_one_condition_is_told(tmp_path: Path) -> None:
    more = "  odd: {warm: warning, cold: fine}\n"
    assert len(remarks_of(tmp_path, "say: '{odd}'", more=more)) == 1


def test_effects_of_states_are_looked_at_as_well(tmp_path: Path) -> None:
    more = "engagement: {on_enter: {Wait: {say: warning}}}\n"
    told_of = remarks_of(tmp_path, "say: x", more=more)
    assert [line for line in told_of if "on_enter.Wait.say: this is warning; mend it" in line]


def test_what_is_not_right_by_its_description_is_not_looked_at(tmp_path: Path) -> None:
    remarks_of(tmp_path, "say: [x]", "say: {loud: 1}", "say: x, loud: much")
    assert Critic.asked == []


def test_what_has_been_said_of_it_is_not_said_again(tmp_path: Path) -> None:
    assert remarks_of(tmp_path, "read: gone.txt") == [
        "17: warning: P > L0 > read: there is no file 'gone.txt'"
    ]


def test_a_driver_that_fails_is_told_of_and_harms_nothing(tmp_path: Path) -> None:
    (line,) = remarks_of(tmp_path, "say: crash")
    assert line.endswith("it fails to check this: ZeroDivisionError('oops')")


def test_of_a_hopeless_file_no_more_is_looked_at(tmp_path: Path) -> None:
    remarks_of(tmp_path, *["say: warning"] * (3 * MAX_PROBLEMS))
    assert len(Critic.asked) <= MAX_PROBLEMS + 2


@pytest.mark.parametrize("pin", ["1234", "is 1234", "{pin}", "{name} 1234 {participant}"])
def test_a_secret_in_a_file_refuses_it_without_being_repeated(tmp_path: Path, pin: str) -> None:
    (line,) = remarks_of(tmp_path, f"enter: '{pin}'")
    assert line.startswith("17: P > L0 > enter: this looks like a password")
    assert "1234" not in line


def test_what_hides_nothing_passes(tmp_path: Path) -> None:
    assert remarks_of(tmp_path, "enter: '{participant} of {name}'") == []


def test_what_a_driver_would_ask_for_tells_no_secret_either(tmp_path: Path) -> None:
    class Asking(Bare):
        Settings: ClassVar[type] = NoSettings

        @classmethod
        def offer(cls, settings: Any) -> Offer:
            return Offer(
                asks=(("button", Ask("verb", "enter", {"pin": "1234"})), ("mark", Ask("mark", "x")))
            )

    path = tmp_path / "e.yaml"
    path.write_text(
        "title: T\nrobot: {drivers: {it: {type: critic}, panel: {type: asking}}}\n"
        "panels: [{title: P, actions: [{label: L, say: x}]}]\n"
    )
    with pytest.raises(ExperimentError) as raised:
        load(path, {**CATALOGUE, "asking": Asking})
    (problem,) = raised.value.problems
    assert problem.path == "robot.drivers.panel.button"
    assert "1234" not in str(problem)
