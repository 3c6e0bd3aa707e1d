"""Two wizards and two robots on three computers, as the how-to page has them: a cable is cut,
datagrams are late and out of order, a computer dies.
"""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field

import pytest

from tests.e2e.computers import Computer, Network
from tests.e2e.lab import Log, recording
from tests.fakes.terminal import ROOT, FakeTerminal

pytestmark = [pytest.mark.real_clock, pytest.mark.safety, pytest.mark.namespaces]

PAGE = (ROOT / "docs/how-to/several-computers.md").read_text(encoding="utf-8")
STUDY, KAREL = re.findall(r"^```yaml\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
COMMANDS = [
    shlex.split(line)
    for block in re.findall(r"^ *```sh\n(.*?)^ *```", PAGE, re.DOTALL | re.MULTILINE)
    for line in block.splitlines()
]


@dataclass
class Study:
    """All three computers while the study is played."""

    network: Network
    text: str = STUDY
    laptop: Computer = field(init=False)
    robot: Computer = field(init=False)
    second: Computer = field(init=False)
    ada: FakeTerminal = field(init=False)
    karel: FakeTerminal = field(init=False)
    drivers: FakeTerminal = field(init=False)

    def __post_init__(self) -> None:
        computers = self.network.computers
        self.laptop, self.robot, self.second = (
            computers[name] for name in ("laptop", "ada.local", "karel.local")
        )
        # Far enough away for whatever happens on the way.
        self.robot.file("door.yaml", self.text.replace("drive: 1", "drive: 5"))
        self.robot.file("karel.yaml", KAREL)
        bea, karel, scp_bea, scp_karel, serve, run, attach = COMMANDS
        for words in (bea, karel):
            assert self.robot.woz(*self.words(self.robot, words)).wait() == 0
        for (_, *files, _), computer in ((scp_bea, self.laptop), (scp_karel, self.second)):
            for file in files:
                shutil.copy(self.robot.folder / file, computer.folder)
        self.drivers = self.second.terminal(self.words(self.second, serve), columns=120)
        session = ("--recordings", str(self.robot.recordings))
        self.ada = self.robot.terminal([*self.words(self.robot, run), *session])
        recording(self.ada)
        self.karel = self.laptop.attach(*self.words(self.laptop, attach)[1:])
        self.log.wait("driver.connected", driver="karel.body")
        for wizard in (self.ada, self.karel):
            wizard.wait_text("● karel.body")

    def words(self, computer: Computer, command: list[str]) -> list[str]:
        """A command of the page as it is typed there: file names are those of its folder."""
        folder, address = computer.folder, self.robot.address
        words = [word.replace("ada.local", address) for word in command[1:]]
        if "new" in words:
            words += ["-o", f"{words[2]}.access"]
        return [
            str(folder / word) if re.search(r"\.(yaml|access)$", word) else word for word in words
        ]

    @property
    def log(self) -> Log:
        """The log of the session."""
        return self.robot.log


@pytest.fixture
def study() -> Iterator[Study]:
    with Network("laptop", "ada.local", "karel.local") as network:
        yield Study(network)


@pytest.fixture
def patient_study() -> Iterator[Study]:
    """Keys may wait on a crowded machine; for tests in which no network holds them back."""
    patient = STUDY.replace("session: {", "session: {stale_after: 30 s, ")
    assert patient != STUDY
    with Network("laptop", "ada.local", "karel.local") as network:
        yield Study(network, patient)


def under_way(log: Log, verb: str, count: int = 1) -> str:
    """The id of the command of this verb that has begun last."""
    line = log.wait("command.requested", count, verb=verb)
    log.wait("command.progress", command=line.fields["command"])
    return str(line.fields["command"])


def test_a_wizards_cable_is_cut_and_mended(study: Study) -> None:
    log = study.log
    study.ada.send("a")
    study.karel.send("f")
    story, way = under_way(log, "say"), under_way(log, "drive")
    study.network.change("laptop", cut=True)
    study.karel.send("k")  # the console does not know yet
    log.wait("console.lost", part="karel")
    log.wait("stop.pressed", scope="drive")
    log.wait("command.stopped", command=way)
    study.ada.wait_text("▲ wizard karel")  # two robots leave little room
    study.karel.wait_text("LINE LOST")
    study.karel.send("\r")
    study.karel.send("l")  # the console knows
    # Nobody else plays Karel, so the other wizard does. What Ada says goes on.
    study.ada.send("k")
    log.wait("action.done", action="Karel nods")
    study.network.change("laptop", cut=False)
    log.wait("console.attached", 2, part="karel")
    study.karel.wait_text("is back")
    assert not log.lines("command.stopped", command=story)
    study.karel.send("k")
    log.wait("action.done", 2, action="Karel nods")
    asked = [line.fields for line in log.lines("action.requested", action="Karel nods")]
    consoles = [line.fields["console"] for line in log.lines("console.attached", part="karel")]
    assert [fields["console"] for fields in asked] == ["con1", consoles[1]]
    assert not log.lines("action.requested", action="Karel explains")


def test_a_robots_computer_dies_during_a_command(patient_study: Study) -> None:
    study = patient_study
    log = study.log
    study.ada.send("a")
    study.karel.send("l")
    under_way(log, "say", 2)
    study.network.change("karel.local", cut=True)  # without power it says no word
    study.second.kill()
    study.karel.send("\x1b")
    stopped = log.wait("stop.confirmed")
    assert (stopped.fields["confirmed"], stopped.fields["unreached"]) == (
        ["ada.robot"],
        ["karel.body"],
    )
    log.wait("driver.lost", driver="karel.body")
    for wizard in (study.ada, study.karel):
        wizard.wait_text("NOT REACHED: karel")
        wizard.wait_text("✗ karel.body lost")
    study.ada.wait_text("STOPPED by karel")
    # Either may release it, is told who may still move, and plays on with the other robot.
    study.ada.send("\x12")
    study.ada.wait_text("not reached: karel")
    study.ada.send("\r")
    log.wait("stop.released", console="con1")
    study.ada.send("n")
    log.wait("action.done", action="Ada nods")
    study.karel.send("k")
    log.wait("action.failed", action="Karel nods")


def test_the_sessions_computer_dies_while_all_is_under_way(patient_study: Study) -> None:
    study = patient_study
    log = study.log
    study.karel.send("l")
    under_way(log, "say")
    study.network.change("ada.local", cut=True)
    study.robot.kill()
    study.drivers.wait_text("karel.body is stopped")
    study.karel.wait_text("LINE LOST")
    study.karel.send("\r\x1b")
    study.karel.wait_text("STOP NOT DELIVERED")


def test_a_slow_network_out_of_order(study: Study) -> None:
    """200 ms there and back and up to 50 ms more, so that datagrams overtake each other."""
    log = study.log
    study.network.change("laptop", delay=0.1, jitter=0.05)
    study.network.change("karel.local", jitter=0.02)
    for number in range(1, 4):
        study.karel.send("k")
        log.wait("action.done", number, action="Karel nods")  # a key counts once while it runs
    study.karel.send("l")
    story = under_way(log, "say")
    study.ada.send("\x1b")
    log.wait("command.stopped", command=story)
    study.karel.wait_text("STOPPED by ada")
    # What was frozen in the cable and comes after the stop is not played.
    study.network.change("laptop", frozen=True)
    study.karel.send("\x12")
    study.karel.send("f")
    study.karel.wait_text("LINE LOST")
    study.network.change("laptop", frozen=False)
    log.wait("console.attached", 2, part="karel")
    study.karel.wait_text("is back")
    assert not log.lines("stop.released")
    assert not log.lines("command.dispatched", verb="drive")
