"""What `woz check --all` tells of people's data: what the file says, and what it does not."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.microphone import Microphone

from tests.config.reading import HELLO, panel
from woz_tui.cli import main
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver
from woz_tui.drivers.plugins import installed
from woz_tui.session.people_data import people_lines


def told(folder: Path, head: str, *actions: str) -> dict[str, list[str]]:
    """Sentences by what they are about."""
    path = folder / "experiment.yaml"
    path.write_text(panel(*(actions or [HELLO]), head=f"title: T\n{head}"), encoding="utf-8")
    found: dict[str, list[str]] = {}
    for about, sentence in people_lines(load(path, installed()), installed()):
        found.setdefault(about, []).append(sentence)
    return found


def test_a_small_file_lets_nothing_leave_and_names_what_it_does_not_say(tmp_path: Path) -> None:
    lines = told(tmp_path, "robot: simulated\n")
    assert lines["leaves"] == ["nothing of which this file tells"]
    assert "codes of participants" in lines["kept"][0]
    assert lines["decides"] == [
        "a wizard, of what keys and the script say and of what is typed",
        "programs that join (`woz mcp` too), by themselves; `programs:` changes that",
    ]
    for about in ("consent", "how long", "withdrawal", "minors"):
        assert len(lines[about]) == 1
        assert "not in this file" in lines[about][0], about


@pytest.mark.parametrize(
    ("url", "leaves"),
    [
        (
            "https://models.example/v1",
            "to models.example, by `woz suggest`: its prompt and the last turns of the dialogue,"
            " each time a visitor has spoken",
        ),
        (
            "http://127.0.0.1:8080/v1",
            "not for the model of `woz suggest`, which is at http://127.0.0.1:8080/v1",
        ),
    ],
)
def test_where_a_model_reads_what_visitors_say(tmp_path: Path, url: str, leaves: str) -> None:
    lines = told(tmp_path, f"robot: simulated\nsuggest: {{model: {{url: '{url}'}}}}\n")
    assert lines["leaves"] == [leaves]
    assert "each request to the model and its whole answer, in the log" in lines["kept"]
    assert "a wizard, of each sentence of the model, before it is said" in lines["decides"]


def test_who_decides_what_programs_and_states_let_it_say(tmp_path: Path) -> None:
    head = (
        "robot: simulated\n"
        "programs: {greeter: {play: [say]}, music: play}\n"
        "suggest: {within: 20 s}\n"
        "engagement:\n"
        "  handshake: {by: robot}\n"
        "  on_enter: {Wait: {say: Hello}, UserSpeaks: {eyes: red}}\n"
    )
    assert told(tmp_path, head)["decides"][1:] == [
        "nobody: the robot itself asks people for their names",
        "nobody: what is said as a state begins: Wait",
        "a wizard, of what mcp asks for; no answer within 20 s is a no",
        "a wizard, of what greeter asks for; no answer within 20 s is a no; say it plays by itself",
        "music, by itself: nobody approves what it does",
        "other programs that join, by themselves",
    ]


def test_what_microphones_cameras_and_faces_keep(tmp_path: Path) -> None:
    head = (
        "robot:\n  drivers:\n"
        "    voice: {type: speech}\n"
        "    ear: {type: microphone, transcribe: 'whisper {file}', segments: true}\n"
        "    ears: {type: microphone}\n"
        "    eye: {type: camera, frames: {at_once: true}}\n"
        "    who: {type: faces, identity: true}\n"
    )
    lines = told(tmp_path, head)
    assert lines["leaves"] == [
        "ear: this file does not say whether `whisper {file}`, which gets the sound, sends it on"
    ]
    assert [line for line in lines["kept"] if line.startswith(("ear", "eye", "who"))] == [
        "ear: what people say, as sound: a WAV file of each utterance, beside the log",
        "ear: what people say, as text, in the log",
        "ears: no sound of anybody (segments: false)",
        "eye: pictures, people on them, as files beside the log, from the beginning",
        "who: where faces are and whether they look here, in the log; no pictures",
        "who: of people who have consented: features of their faces, in a store beside",
    ]


def test_a_pepper_is_another_computer_unless_it_is_simulated(tmp_path: Path) -> None:
    head = (
        "robot: {drivers: {pepper: {type: pepper, robots: [%s], recognition: {phrases: [yes]}}}}\n"
    )
    lines = told(tmp_path, head % "simulated, 192.168.1.30, 'tcps://nao@192.168.1.31'")
    assert lines["leaves"] == [
        "pepper: between this computer and 192.168.1.30, tcps://nao@192.168.1.31: what it says and"
        " senses"
    ]
    heard = "pepper: which phrases of a list people say, as the robot understands them, in the log"
    assert heard in lines["kept"]
    lines = told(tmp_path, head % "simulated")
    assert lines["leaves"] == ["nothing of which this file tells"]
    assert heard not in lines["kept"]


def test_what_is_known_of_participants_and_who_may_join(tmp_path: Path) -> None:
    head = (
        "robot: {drivers: {nao: {type: furhat, address: 192.168.1.20}}}\n"
        "participants: {fields: {first: text, group: [child, adult]}}\n"
        "session: {access: {anna: wizard}}\n"
        "preflight: [The consent form is signed]\n"
        "lsl: {shares: [texts]}\n"
    )
    action = "{key: w, label: W, say: {by: participant.group, child: Look, else: A whale}}"
    lines = told(tmp_path, head, action)
    assert "of each participant: first (text), group (child, adult), in the log" in lines["kept"]
    assert lines["leaves"][0] == (
        "between this computer and 192.168.1.20: what nao says and senses"
    )
    assert lines["leaves"][-2:] == [
        "to every recorder of the lab's network, by `woz lsl`: events, texts",
        "to who may join from another machine: anna (wizard)",
    ]
    assert lines["consent"][0].endswith("a person checks: The consent form is signed")
    assert lines["minors"][0].endswith("texts are chosen by participant.group: child, else")


class UnsureDriver(Microphone):
    """Somebody's, of which nothing is known then."""

    @classmethod
    def people_data(cls, settings: Any) -> Iterable[tuple[str, str]]:
        yield "kept", "some sound"
        raise RuntimeError("no idea")


class AskingDriver(Microphone):
    """Somebody's, with a word of its own."""

    @classmethod
    def people_data(cls, settings: Any) -> Iterable[tuple[str, str]]:
        yield "goes", "some sound"


@pytest.mark.parametrize(
    ("driver", "why"),
    [
        (UnsureDriver, "RuntimeError: no idea"),
        (AskingDriver, "ValueError: 'goes' is none of LEAVES, KEPT and DECIDES"),
    ],
)
def test_a_driver_that_fails_to_say_it_is_named(
    tmp_path: Path, driver: type[Driver], why: str
) -> None:
    path = tmp_path / "experiment.yaml"
    head = "title: T\nrobot: {drivers: {voice: {type: speech}, ear: {type: microphone}}}\n"
    path.write_text(panel(HELLO, head=head), encoding="utf-8")
    catalogue = {**installed(), "microphone": driver}
    lines = [*people_lines(load(path, catalogue), catalogue)]
    assert [sentence for about, sentence in lines if about == "leaves"] == [
        f"ear: its driver fails to say what becomes of people's data ({why})"
    ]
    assert "withdrawal" in dict(lines)


def test_it_stands_in_woz_check_all_and_not_without(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "experiment.yaml"
    path.write_text(panel(HELLO), encoding="utf-8")
    assert main(["check", "--all", str(path)]) == 0
    assert "people's data, for an ethics application" in capsys.readouterr().out
    assert main(["check", str(path)]) == 0
    assert "ethics" not in capsys.readouterr().out


def test_what_is_told_for_a_board_holds_no_password_of_an_address(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = "[curl, 'https://me:hunter2@asr.example/x?token=abc123', '{file}']"
    head = (
        f"title: T\nrobot: {{drivers: {{ear: {{type: microphone, transcribe: {program}}},"
        " body: {type: simulated}}}\n"
        "suggest: {model: {url: 'http://me:hunter3@127.0.0.1:8080/v1'}}\n"
    )
    path = tmp_path / "experiment.yaml"
    path.write_text(panel(HELLO, head=head), encoding="utf-8")
    assert main(["check", "--all", str(path)]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "me:***@asr.example" in said
    assert "me:***@127.0.0.1" in said
    assert not {"hunter2", "hunter3", "abc123"} & set(re.findall(r"\w+", said))
