"""What `woz check` says of commands to a Pepper before there is one."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from woz_drivers.pepper import Pepper
from woz_drivers.pepper.settings import PepperSettings, TabletSettings

from tests.drivers.pepper.test_address import TELLING
from tests.drivers.pepper.test_tags import RIGHT
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.contract import UNKNOWN, Written
from woz_tui.protocol.messages import Json

SETTINGS = PepperSettings(robots=(), tablet=TabletSettings(root="pictures"))


def remarks_of(folder: Path, verb: str, **args: Json) -> list[str]:
    found = [*Pepper.remarks(SETTINGS, Written(verb, args, folder))]
    assert {finding.subject for finding in found} <= set(args)
    return [f"{finding.level}: {finding.text}; {finding.remedy}" for finding in found]


@pytest.mark.parametrize(
    ("verb", "args", "says"),
    [
        ("say", {"text": r"Hi \foo=1\ there"}, r"\foo=1\ is no tag that the robot knows; correct"),
        ("say", {"text": r"Hi \rspd=900\ there"}, "needs a number of 50 to 400 %"),
        ("say", {"text": "Hi ^run(animations/Stand"}, "not closed"),
        ("read", {"file": "gone.txt"}, "there is no file 'gone.txt'; put it there"),
        ("read", {"file": "empty.txt"}, "has no text in it"),
        ("read", {"file": "wrong.txt"}, r"line 4 of 'wrong.txt': \pua=3\ is no tag"),
        ("read", {"file": "pipe"}, "there is no file 'pipe'"),
        ("screen", {"file": "gone.png"}, "there is no file 'gone.png'; check its name, and tablet"),
        ("screen", {"file": "folder.png"}, "there is no file 'folder.png'"),
        ("screen", {"file": "gone.mp4"}, "there is no file 'gone.mp4'"),
        ("screen", {"file": "plan.doc"}, "cannot show 'plan.doc'"),
        ("screen", {"file": "ftp://a/b.png"}, "cannot fetch"),
        ("sound", {"file": "gong.wav"}, "there is no file 'gong.wav'"),
        ("sound", {"file": __file__}, "is a file of this machine"),
        ("play", {"move": "Heey_1"}, "did you mean 'Hey_1'?"),
        ("eyes", {"color": "grean"}, "did you mean 'green'?"),
        ("pose", {"joints": {"HeadYaw": 100, "HeadPitch": 20}}, "with the head turned by 100"),
        ("naoqi", {"call": "getSummary", "args": "[]"}, "is no call; write Service.method"),
        ("naoqi", {"call": "A.b", "args": "[1"}, "no JSON list"),
        ("naoqi", {"call": "ALFaceDetection.learnFace"}, "learns a face, which needs a consent"),
        ("naoqi", {"call": "ALMotion.moveTo"}, "may drive the robot; play `naoqi_drive`"),
        ("naoqi_drive", {"call": "ALMotion.move"}, "may drive the robot when it is over"),
        ("connect", {"robot": "no host"}, "this is no name of a host"),
    ],
)
def test_what_is_odd_is_a_warning_with_a_remedy(
    tmp_path: Path, verb: str, args: dict[str, Json], says: str
) -> None:
    (tmp_path / "empty.txt").write_text(" \n\n")
    (tmp_path / "wrong.txt").write_text("Hello.\n\nThis is\n\\pua=3\\ wrong.\n")
    (tmp_path / "folder.png").mkdir()
    os.mkfifo(tmp_path / "pipe")
    (line,) = remarks_of(tmp_path, verb, **args)
    assert line.startswith("warning: ")
    assert says in line
    assert str(tmp_path) not in line


def test_what_is_right_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "map.png").touch()
    (tmp_path / "film.mp4").touch()
    (tmp_path / "text.txt").write_text("\n\n".join(RIGHT), encoding="utf-8")
    (tmp_path / "huge.txt").write_text("\\foo=1\\" * 100_000)
    right: list[tuple[str, Json]] = [
        *(("say", text) for text in RIGHT),
        *(("screen", shown) for shown in ("map.png", "film.mp4", "off", "http://a/b")),
        *(("read", name) for name in ("text.txt", "huge.txt")),
        *(("sound", name) for name in ("text.txt", "/home/nao/gong.wav", "http://a/b.mp3")),
        ("play", "Hey_1"),
        ("eyes", "#ff8000"),
        ("pose", {"HeadYaw": 10.0}),
        ("naoqi", "ALMotion.getSummary"),
        ("connect", ""),
    ]
    mains = {
        verb.name: verb.arguments[0].name for verb in Pepper.offer(SETTINGS).verbs if verb.arguments
    }
    for verb, value in right:
        assert remarks_of(tmp_path, verb, **{mains[verb]: value}) == [], (verb, value)
    assert remarks_of(tmp_path, "disconnect") == []


@pytest.mark.parametrize("text", [text for text, _ in TELLING])
def test_a_password_in_an_address_is_an_error_that_does_not_repeat_it(
    tmp_path: Path, text: str
) -> None:
    (line,) = remarks_of(tmp_path, "connect", robot=text)
    assert line.startswith("error: ")
    assert "Hush" not in line


# -- what only the session knows -------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        rf"\rspd={UNKNOWN}\ fast",
        rf"\rspd=9{UNKNOWN}\ fast",
        rf"\rst{UNKNOWN} as before",
        f"^run(animations/{UNKNOWN})",
        f"^run(animations/{UNKNOWN} and on",
        rf"\{UNKNOWN}=80\ ",
    ],
)
def test_a_tag_with_a_variable_in_it_is_not_judged(tmp_path: Path, text: str) -> None:
    assert remarks_of(tmp_path, "say", text=text) == []


def test_a_wrong_tag_beside_a_variable_is_told(tmp_path: Path) -> None:
    assert len(remarks_of(tmp_path, "say", text=rf"Dear {UNKNOWN}, \foo=1\ and {UNKNOWN}")) == 1


@pytest.mark.parametrize(
    ("verb", "argument"),
    [
        ("read", "file"),
        ("screen", "file"),
        ("sound", "file"),
        ("play", "move"),
        ("eyes", "color"),
        ("connect", "robot"),
    ],
)
def test_a_name_with_a_variable_in_it_is_not_judged(
    tmp_path: Path, verb: str, argument: str
) -> None:
    assert remarks_of(tmp_path, verb, **{argument: f"x{UNKNOWN}:y"}) == []


@given(
    st.sampled_from(sorted({verb.name for verb in Pepper.offer(SETTINGS).verbs})),
    st.text(max_size=30) | st.text("\\^=(){}/~.:@a1 \0", max_size=30),
)
def test_whatever_is_written_is_looked_at(verb: str, text: str) -> None:
    offered = {one.name: one for one in Pepper.offer(SETTINGS).verbs}[verb]
    args: dict[str, Json] = {
        argument.name: text for argument in offered.arguments if argument.kind in ("text", "file")
    }
    remarks_of(Path("/nowhere"), verb, **args)


# -- in a file -----------------------------------------------------------------------------------

EXPERIMENT = """\
title: T
robot: {{drivers: {{pepper: {{type: pepper, robots: {robots}}}}}}}
variables: {{ip: "{ip}"}}
panels: [{{title: A, actions: [{{label: L, {does}}}]}}]
"""


def problems(folder: Path, robots: str = "[]", ip: str = "", does: str = "say: Hi") -> list[str]:
    file = folder / "e.yaml"
    file.write_text(EXPERIMENT.format(robots=robots, ip=ip, does=does), encoding="utf-8")
    try:
        found = [*load(file, {"pepper": Pepper}).warnings]
    except ExperimentError as error:
        found = error.problems
    return [str(one).removeprefix(f"{file}:") for one in found]


def test_a_tag_is_told_at_its_line_and_the_robot_still_plays(tmp_path: Path) -> None:
    assert problems(tmp_path, does=r"say: 'Hi {participant}, \vol=300\ now'") == [
        "4:42: warning: A > L > say:"
        r" \vol=300\ needs a number of 0 to 100 %, as in \vol=80"
        "\\"
    ]


@pytest.mark.parametrize(
    ("given", "place"),
    [
        ({"robots": "['tcps://nao:Hush!42@10.0.0.1']"}, "2:51: robot.drivers.pepper.robots[0]: a"),
        ({"robots": "'tcps://nao:Hush!42@10.0.0.1'"}, "2:42: robot.drivers.pepper.robots: exp"),
        ({"robots": "{'nao:Hush!42@10.0.0.1': 1}"}, "2:42: robot.drivers.pepper.robots: exp"),
        ({"does": "connect: 'nao:Hush!42@10.0.0.1'"}, "4:42: A > L > connect: a"),
        ({"ip": "nao:Hush!42@h", "does": "connect: '{ip}'"}, "4:42: A > L > connect"),
        ({"does": "connect: {'nao:Hush!42@h': 1}"}, "4:52: A > L > connect.nao:***@h"),
    ],
)
def test_no_password_in_a_file_gets_further_than_its_refusal(
    tmp_path: Path, given: dict[str, str], place: str
) -> None:
    told = problems(tmp_path, **given)
    assert len(told) == 1
    assert told[0].startswith(place)
    assert "Hush" not in told[0]


@pytest.mark.parametrize(("client", "warns"), [("qi", 1), ("own", 0), ("auto", 0)])
def test_a_client_named_from_before_is_taken_with_a_warning(
    tmp_path: Path, client: str, warns: int
) -> None:
    file = tmp_path / "experiment.yaml"
    file.write_text(
        "title: T\npanels: [{title: P, actions: [{key: h, label: Hi, say: Hi}]}]\nrobot:\n"
        "  drivers:\n    pepper:\n      type: pepper\n      robots: [simulated]\n"
        f"      client: {client}\n"
    )
    found = [one for one in load(file, {"pepper": Pepper}).warnings if one.path.endswith("client")]
    assert len(found) == warns
    for problem in found:
        assert problem.place.line == 8
        assert "own client" in problem.message
