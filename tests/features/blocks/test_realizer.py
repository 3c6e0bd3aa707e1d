"""Blocks that are played in a real session, and what the planner is told of it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as Xml

import pytest

from tests.host.rig import ServedSession, served_session
from tests.session.rig import ScriptedDriver
from woz_tui import cli
from woz_tui.bridge.xml_elements import LONGEST
from woz_tui.client import connect
from woz_tui.drivers.contract import Argument, DriverContext, Forecast, Verb
from woz_tui.features.blocks.behaviour_calls import BehaviourCalls, UnplayableError
from woz_tui.features.blocks.bml_block import NAMESPACE, Behaviour
from woz_tui.features.blocks.realizer import BmlRealizer, Feedback
from woz_tui.protocol import messages as m
from woz_tui.testing import until

PATIENCE_S = 40.0
XML = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{}" {}>{}</bml>'
SAY = '<speech id="s"><text>Hello <sync id="m"/>you.</text></speech>'
NOD = '<head id="n" lexeme="NOD" start="s:m"/>'


@dataclass
class Planner:
    """A planner that writes down what it is told."""

    host: ServedSession
    realizer: BmlRealizer
    told: list[Feedback]

    async def play(self, name: str, inner: str, more: str = "") -> None:
        """A block, to its end."""
        await self.realizer.perform(XML.format(name, more, inner))
        async with asyncio.timeout(PATIENCE_S):
            await self.realizer.until_over(name)

    def progress(self) -> list[str]:
        """Ids of the progress so far."""
        return [each.attributes["id"] for each in self.told if each.name.endswith("Progress")]

    def warnings(self) -> list[tuple[str, str]]:
        """What was refused: the kind, and about what."""
        return [
            (each.attributes["type"], each.attributes["id"])
            for each in self.told
            if each.name == "warningFeedback"
        ]

    def verbs(self) -> list[str]:
        """What the robot was called to do."""
        return [verb for verb, _ in self.host.driver().calls]


@pytest.fixture
async def planner(tmp_path: Path) -> AsyncIterator[Planner]:
    async with served_session(tmp_path) as host, connect(host.path, name="planner") as client:
        told: list[Feedback] = []
        realizer = BmlRealizer(client, told.append)
        yield Planner(host, realizer, told)
        await realizer.close()


async def test_a_block_is_foretold_played_and_told_point_by_point(planner: Planner) -> None:
    await planner.play("b1", SAY + NOD)
    assert planner.verbs() == ["say", "play"]
    assert planner.told[0].name == "predictionFeedback"
    progress = planner.progress()
    assert progress[0] == "b1:start"
    assert progress[-1] == "b1:end"
    speech = [each for each in progress if each.startswith("b1:s:")]
    assert speech == ["b1:s:start", "b1:s:m", "b1:s:end"]
    assert progress.index("b1:s:m") < progress.index("b1:n:stroke") < progress.index("b1:n:end")
    assert not planner.warnings()
    requests = planner.host.of(m.Command)
    assert {line.source for line in requests} == {"program"}


async def test_planners_find_their_behaviours_in_what_is_foretold(planner: Planner) -> None:
    speech = SAY.replace("<text>", "<text>1 &lt; 2 <sync id='a b'/><sync id='end'/>")
    shift = '<postureShift id="p" bmlt:x="1" xmlns:bmlt="y"><stance type="Sitting"/></postureShift>'
    await planner.play("b1", speech + NOD.replace("/>", ' amount="0.7"/>') + shift)
    feedback = next(each for each in planner.told if each.name == "predictionFeedback")
    read = Xml.fromstring(feedback.xml())
    ns = f"{{{NAMESPACE}}}"
    block, said, nod, posture = read
    assert block.get("id") == "b1"
    text = said.find(f"{ns}text")
    assert text is not None
    assert text.text == "1 < 2 Hello you."
    assert {*said.keys()} == {"id", "start", "m", "end"}
    wanted = {"id": "b1:n", "lexeme": "NOD", "amount": "0.7", "start": said.get("m")}
    assert wanted.items() <= nod.attrib.items()
    assert posture[0].attrib == {"type": "Sitting"}


async def test_blocks_wait_join_in_and_take_over_as_they_say(planner: Planner) -> None:
    long = '<wait id="w" end="999"/>'
    await planner.realizer.perform(XML.format("b1", "", long))
    await planner.realizer.perform(
        XML.format("b2", 'composition="APPEND"', NOD.replace("s:m", "0"))
    )
    await planner.play("b3", "")
    assert not {"b1:end", "b2:start"} & {*planner.progress()}
    await planner.realizer.cut("b1")
    async with asyncio.timeout(PATIENCE_S):
        await planner.realizer.until_over("b2")
    progress = planner.progress()
    assert progress.index("b1:end") < progress.index("b2:start")
    await planner.realizer.perform(XML.format("b4", "", long))
    await until(lambda: "b4:start" in planner.progress(), PATIENCE_S)
    await planner.play("b5", "", 'composition="REPLACE"')
    assert {"b4:end", "b5:end"} <= {*planner.progress()}
    assert "b4:w:end" not in planner.progress()


async def test_what_is_appended_waits_for_the_blocks_that_it_names_and_for_no_others(
    planner: Planner,
) -> None:
    long = '<wait id="w" end="999"/>'
    await planner.realizer.perform(XML.format("b1", "", long))
    await planner.realizer.perform(XML.format("b2", "", long))
    await planner.realizer.perform(XML.format("after", 'composition="APPEND-AFTER(b2)"', ""))
    await planner.realizer.perform(XML.format("both", 'composition="APPEND-AFTER(b1, b2)"', ""))
    await planner.realizer.perform(XML.format("all", 'composition="APPEND"', ""))
    await planner.play("gone", "", 'composition="APPEND-AFTER(b0)"')
    assert not {"after:start", "both:start", "all:start"} & {*planner.progress()}
    await planner.realizer.cut("b2")
    async with asyncio.timeout(PATIENCE_S):
        await planner.realizer.until_over("after")
    assert not {"both:start", "all:start"} & {*planner.progress()}
    await planner.realizer.cut("b1")
    async with asyncio.timeout(PATIENCE_S):
        await planner.realizer.until_over("both")
        await planner.realizer.until_over("all")
    progress = planner.progress()
    assert progress.index("both:end") < progress.index("all:start")


async def test_what_the_robot_cannot_do_is_told_and_the_rest_is_played(planner: Planner) -> None:
    gaze = '<gaze id="g" target="moon"/>'
    await planner.play("b1", SAY + gaze)
    assert planner.verbs() == ["say"]
    assert [about for _, about in planner.warnings()] == ["b1:g"]
    await planner.play("b2", SAY + f"<required>{gaze}</required>")
    assert planner.verbs() == ["say"]
    assert planner.warnings()[-1][1] == "b2"
    late = NOD.replace("s:m", "g:end")
    await planner.play("b3", late + gaze)
    assert [about for _, about in planner.warnings()[-2:]] == ["b3:g", "b3:n"]
    before = planner.verbs()
    await planner.play("b4", f"<required>{late}</required>{gaze}")
    assert planner.verbs() == before
    assert planner.warnings()[-1][1] == "b4"


async def test_a_stop_ends_the_block_and_the_next_is_refused(planner: Planner) -> None:
    await planner.realizer.perform(XML.format("b1", "", SAY))
    await until(lambda: "say" in planner.verbs(), PATIENCE_S)
    planner.host.session.stop("key")
    async with asyncio.timeout(PATIENCE_S):
        await planner.realizer.until_over("b1")
    assert planner.warnings() == [("IMPOSSIBLE_TO_SCHEDULE", "b1")]
    assert "b1:s:end" not in planner.progress()
    before = planner.verbs()
    await planner.play("b2", SAY)
    assert planner.verbs() == before


async def test_two_blocks_of_one_name_and_what_is_none_are_refused(planner: Planner) -> None:
    await planner.realizer.perform(XML.format("b1", "", '<wait id="w" end="99"/>'))
    await planner.realizer.perform(XML.format("b1", "", ""))
    await planner.realizer.perform("<bml")
    await until(lambda: len(planner.warnings()) == 2, PATIENCE_S)
    assert {about for _, about in planner.warnings()} == {"b1", "bml"}
    await planner.realizer.cut("b1")
    await until(lambda: "b1:end" in planner.progress(), PATIENCE_S)


async def test_a_block_under_way_is_not_forgotten_over_many_others(
    planner: Planner, monkeypatch: pytest.MonkeyPatch
) -> None:
    for place in ("player", "realizer"):
        monkeypatch.setattr(f"woz_tui.features.blocks.{place}.REMEMBERED", 1)
    await planner.realizer.perform(XML.format("long", "", '<wait id="w" end="999"/>'))
    for number in range(3):
        await planner.play(f"b{number}", "")
    await planner.play("last", "", 'composition="REPLACE"')
    await until(lambda: "long:end" in planner.progress(), PATIENCE_S)


async def test_the_longest_block_is_played_and_a_longer_one_keeps_the_connection(
    planner: Planner,
) -> None:
    said = '"' * (LONGEST - len(XML.format("b1", "", "")) - 80)
    await planner.realizer.perform(XML.format("b1", "", f"<!--{said}-->"))
    await until(lambda: "b1:end" in planner.progress(), PATIENCE_S)
    assert await planner.realizer.perform(XML.format("b2", "", "x" * (1 << 20))) == ""
    assert [sort for sort, _ in planner.warnings()] == ["PARSING_FAILURE"]
    await planner.play("b3", SAY)
    assert "b3:s:end" in planner.progress()


def test_feedback_is_xml_whatever_the_names_are() -> None:
    feedback = Feedback("warningFeedback", {"id": '"<&>'}, "a < b & c", (Feedback("x", {}),))
    read = Xml.fromstring(feedback.xml())
    assert read.get("id") == '"<&>'
    assert read.text == "a < b & c"


# -- which verbs -------------------------------------------------------------------------------


def _robot() -> BehaviourCalls:
    def verb(name: str, **choices: list[str]) -> tuple[str, Verb]:
        arguments = [
            Argument(each, "text", choices=tuple(words)) for each, words in choices.items()
        ]
        return "robot", Verb(name, "", tuple(arguments), lane=name)

    return BehaviourCalls(
        [
            verb("say", text=[]),
            verb("play", move=["nod", "shake", "point-left", "sit"], speed=[]),
            verb("gaze", yaw=[], pitch=[], seconds=[]),
            verb("emotion", emotion=["happy", "neutral"]),
        ]
    )


@dataclass
class Case:
    """A behaviour and the verbs that it stands for."""

    kind: str
    attributes: dict[str, str]
    verbs: list[tuple[str, str, dict[str, object]]]
    inner: dict[str, dict[str, str]] = field(default_factory=dict)


@pytest.mark.parametrize(
    "case",
    [
        Case("head", {"lexeme": "SHAKE"}, [("start", "play", {"move": "shake"})]),
        Case("pointing", {"target": "40, 0"}, [("start", "play", {"move": "point-left"})]),
        Case(
            "gaze",
            {"target": "left", "offsetAngle": "10", "offsetDirection": "RIGHT"},
            [
                ("start", "gaze", {"yaw": 20.0, "pitch": 0.0}),
                ("relax", "gaze", {"yaw": 0.0, "pitch": 0.0}),
            ],
        ),
        Case("gazeShift", {"target": "up"}, [("start", "gaze", {"yaw": 0.0, "pitch": -20.0})]),
        Case(
            "faceLexeme",
            {"lexeme": "smile"},
            [
                ("start", "emotion", {"emotion": "happy"}),
                ("relax", "emotion", {"emotion": "neutral"}),
            ],
        ),
        Case(
            "postureShift",
            {},
            [("start", "play", {"move": "sit"})],
            {"stance": {"type": "Sitting"}},
        ),
        Case("wait", {}, []),
    ],
)
def test_behaviours_stand_for_verbs(case: Case) -> None:
    behaviour = Behaviour(case.kind, "x", case.attributes, inner=case.inner)
    calls = _robot().calls(behaviour)
    assert [(call.point, call.verb, dict(call.args)) for call in calls] == case.verbs


@pytest.mark.parametrize(
    ("kind", "attributes", "why"),
    [
        ("head", {"lexeme": "SPIN"}, "BEHAVIOR_TYPE_NOT_SUPPORTED"),
        ("gaze", {"target": "moon"}, "NO_SUCH_TARGET"),
        ("faceLexeme", {"lexeme": "OBSCURE"}, "BEHAVIOR_TYPE_NOT_SUPPORTED"),
        ("locomotion", {"target": "door"}, "BEHAVIOR_TYPE_NOT_SUPPORTED"),
        ("posture", {}, "BEHAVIOR_TYPE_NOT_SUPPORTED"),
    ],
)
def test_what_no_verb_plays_is_told(kind: str, attributes: dict[str, str], why: str) -> None:
    with pytest.raises(UnplayableError) as caught:
        _robot().calls(Behaviour(kind, "x", attributes))
    assert caught.value.kind == why


# -- the command -------------------------------------------------------------------------------


def test_the_timetable_is_printed_without_a_session(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "greet.xml"
    file.write_text(XML.format("b1", "", SAY + NOD + '<head id="z" lexeme="NOD" start="z2:end"/>'))
    assert cli.main(["bml", "--dry-run", str(file)]) == 0
    printed = capsys.readouterr().out
    assert "greet.xml" in printed
    assert "left out" in printed
    file.write_text(XML.format("b1", "", "<!-- f\u00fcr -->"), "latin-1")
    assert cli.main(["bml", "--dry-run", str(file)]) == 1
    assert "UTF-8" in capsys.readouterr().err
    file.write_text("nothing")
    assert cli.main(["bml", "--dry-run", str(file)]) == 1
    assert "greet.xml" in capsys.readouterr().err


def test_the_timetable_says_what_a_robot_does_and_shows_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "greet.xml"
    file.write_text(XML.format("b1", "", SAY + NOD + '<faceLexeme id="f" lexeme="SMILE"/>'))
    for robot, does in (("pepper", "Yes_1"), ("reachy-mini", "play nod"), ("furhat", "happy")):
        assert cli.main(["bml", "--dry-run", "--robot", robot, str(file)]) == 0
        printed = capsys.readouterr().out
        assert does in printed
        assert "left out" not in printed
        [speech] = [line for line in printed.splitlines() if line.startswith("s ") and "╋" in line]
        assert "━" in speech
        assert any(line.startswith("n") and "◆" in line for line in printed.splitlines())
    assert cli.main(["bml", "--dry-run", "--robot", "servo-head", str(file)]) == 0
    assert "BEHAVIOR_TYPE_NOT_SUPPORTED" in capsys.readouterr().out
    (tmp_path / "robots").mkdir()
    (tmp_path / "robots" / "mine.yaml").write_text("{name: mine, drivers: {m: {type: simulated}}}")
    assert cli.main(["bml", "--dry-run", "--robot", "mine", str(file)]) == 0, "beside the block"
    assert "on mine" in capsys.readouterr().out
    assert cli.main(["bml", "--dry-run", "--robot", "peper", str(file)]) == 1
    assert "pepper" in capsys.readouterr().err


async def test_a_session_foretells_what_it_would_do(planner: Planner) -> None:
    block = await planner.realizer.predict(XML.format("b1", "", SAY + NOD + "<head/>"))
    assert [each.does for each in block.behaviours] == ["say Hello you.", "play nod"]
    assert [problem.sort for problem in block.problems] == ["PARSING_FAILURE"]
    assert not planner.verbs()


async def test_a_planner_that_leaves_takes_its_blocks_along(tmp_path: Path) -> None:
    async with served_session(tmp_path) as host:
        async with connect(host.path, name="planner") as client:
            realizer = BmlRealizer(client, lambda feedback: None)
            await realizer.perform(XML.format("b1", "", '<wait id="w" end="99"/>'))
        over = await host.published(lambda line: isinstance(line, m.Stopped))
        assert isinstance(over, m.Stopped)
        assert over.driver == "bml"


async def test_woz_bml_says_which_file_and_what_of_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    broken, lost = tmp_path / "broken.xml", tmp_path / "lost.xml"
    broken.write_text("<bml")
    lost.write_text(XML.format("b1", "", '<gaze id="g" target="door"/>'))
    async with served_session(tmp_path) as host:
        words = ["bml", "--session", str(host.path), str(broken), str(lost)]
        assert await asyncio.to_thread(cli.main, words) == 1
    told = capsys.readouterr().err
    assert f"{broken}: " in told
    assert "b1: g: nobody knows where 'door' is" in told
    assert "bml: targets" in told


class SlowVoice(ScriptedDriver):
    """How long a sentence takes it says once it has been asked how long a move takes."""

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._asked = asyncio.Event()

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """Nothing is known."""
        if verb == "play":
            self._asked.set()
        await self._asked.wait()
        return Forecast()


async def test_woz_bml_says_of_which_of_two_files_a_part_is_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    partial, fine, again = (tmp_path / f"{name}.xml" for name in ("partial", "fine", "again"))
    partial.write_text(XML.format("b1", "", f'<head id="h"/>{SAY}'))
    fine.write_text(XML.format("b2", "", NOD.replace("s:m", "0")))
    again.write_text(XML.format("b1", 'composition="SOON"', ""))
    async with served_session(tmp_path, catalogue={"puppet": SlowVoice}) as host:
        words = ["bml", "--session", str(host.path), str(partial), str(fine), str(again)]
        assert await asyncio.to_thread(cli.main, words) == 1
    told = capsys.readouterr().err.splitlines()
    assert {line.split(": ")[1] for line in told if "h: lexeme is missing" in line} == {
        str(partial)
    }
    assert {line.split(": ")[1] for line in told if "SOON" in line} == {str(again)}


def test_a_robot_is_named_for_a_timetable_alone_and_that_is_of_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "b.xml"
    file.write_text(XML.format("b1", "", ""))
    for words in (["--robot", "pepper", str(file)], ["--dry-run", "--listen"]):
        assert cli.main(["bml", *words]) == 2
        assert "--dry-run" in capsys.readouterr().err


@pytest.mark.parametrize("address", ["h:99999", "h:0", "h:\u00b2", "h:-1", ":61613", "h:x"])
def test_what_is_no_address_of_a_broker_is_told(
    address: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for command in ("bml", "bridge"):
        assert cli.main([command, "--stomp", address]) == 1
        assert "is no address" in capsys.readouterr().err
