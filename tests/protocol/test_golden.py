"""The wire's format, as files: a change of these lines is a change of every log and program."""

from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import jsonschema
import msgspec
import pytest

from tests.protocol import examples, values
from woz_tui.protocol import codec
from woz_tui.protocol import requests as r
from woz_tui.protocol.messages import ActionDone, Command
from woz_tui.protocol.requests import PROTOCOL as PROTOCOL_VERSION
from woz_tui.protocol.requests import AskAction, Hello

PROTOCOL = Path(__file__).parents[2] / "docs" / "reference" / "protocol.md"

FILES: dict[str, tuple[Callable[[bytes], object], list[type[msgspec.Struct]]]] = {
    "messages.jsonl": (codec.decode_message, list(values.MESSAGES)),
    "requests.jsonl": (codec.decode_request, list(values.REQUESTS)),
    "answers.jsonl": (codec.decode_incoming, list(values.ANSWERS)),
}


def golden_lines(name: str) -> list[bytes]:
    return (examples.GOLDEN / name).read_bytes().splitlines(keepends=True)


@pytest.mark.parametrize("name", FILES)
def test_golden_lines_come_out_as_they_went_in(name: str) -> None:
    decode, _ = FILES[name]
    for line in golden_lines(name):
        decoded = decode(line)
        assert isinstance(decoded, msgspec.Struct), line
        assert codec.encode(decoded) == line


@pytest.mark.parametrize("name", FILES)
def test_golden_files_are_what_todays_code_writes(name: str) -> None:
    assert (examples.GOLDEN / name).read_bytes() == examples.golden()[name]


def test_the_published_schema_takes_what_the_codec_takes() -> None:
    schema = json.loads(PROTOCOL.with_name("protocol.schema.json").read_text())
    of = {"requests.jsonl": "Request", "answers.jsonl": "Answer", "messages.jsonl": "Message"}
    for name, part in of.items():
        validator = jsonschema.Draft202012Validator({**schema, "$ref": f"#/$defs/{part}"})
        for line in golden_lines(name):
            validator.validate(json.loads(line))
    requests = jsonschema.Draft202012Validator(schema)
    for wrong in ({"kind": "dance"}, {"kind": "action", "actin": "x"}, {"kind": "verb"}):
        assert not requests.is_valid(wrong)


@pytest.mark.parametrize("name", FILES)
def test_every_kind_has_a_golden_line(name: str) -> None:
    _, kinds = FILES[name]
    present = {codec.decode_unknown(line)["kind"] for line in golden_lines(name)}
    wanted = {kind.__struct_config__.tag for kind in kinds}
    assert present == wanted, (
        "a kind needs an example: in tests/protocol/examples.py, a feature's among MESSAGES or"
        " REQUESTS of tests/features/NAME/examples.py; then `make generated`"
    )


def test_every_field_appears_in_a_golden_line() -> None:
    for name, (_, kinds) in FILES.items():
        lines = [codec.decode_unknown(line) for line in golden_lines(name)]
        for kind in kinds:
            tag = kind.__struct_config__.tag
            seen = {field for line in lines if line["kind"] == tag for field in line}
            optional = _OPTIONAL.get(str(tag), set()) | (set() if tag == "action" else _SENT)
            optional |= set() if tag in ("command.requested", "notice") else _TELLS
            names_console = getattr(kind, "names_console", False) or kind is Command
            optional |= set() if tag in ("command.refused", "notice", "reply") else _WORDING
            optional |= _CONSOLE if names_console and tag != "marker" else set()
            missing = set(kind.__struct_encode_fields__) - seen - optional
            assert not missing, (
                f"{name}: no line of kind {tag} shows {missing}: fill them in its example (in"
                " tests/protocol, a feature's beside its tests), then `make generated`"
            )


#: Fields that stay away from a golden line on purpose.
_STAMP: set[str] = {"seq", "t", "ts"}
#: The same field of all requests.
_SENT: set[str] = {"sent_us"}
#: The same field of all messages with words.
_TELLS: set[str] = {"tells"}
#: The same field of all that a sentence is refused or told with.
_WORDING: set[str] = {"wording"}
#: The same field of all messages that a request brings about.
_CONSOLE: set[str] = {"console"}
_END: set[str] = {"reason", "remedy"}
_OPTIONAL: dict[str, set[str]] = {
    "segment": _STAMP,
    "session.start": {"redacted"},  # in copies alone
    "sample": {"ts"},
    "engagement.shown": {"ts"},
    "session.changed": {"participant"},
    "participant.withdrawn": {"participant"},
    "recorder.state": {"detail", "remedy"},
    "action.done": {"reason"},
    "command.done": _END,
    "command.timed_out": {"remedy"},
    "command.refused": {"remedy"},
    "command.stopped": {"remedy"},
    "command.superseded": {"remedy"},
    "driver.connecting": {"remedy"},
    "driver.connected": {"remedy"},
    "verb": {"key", "age_us"},
    "action": {"when_busy"},
    "hello": {"protocol"},
}


# -- the document -------------------------------------------------------------------------------

ARROWS: dict[str, Callable[[bytes], object]] = {
    "->": codec.decode_request,
    "<-": codec.decode_incoming,
}


def document_lines() -> list[tuple[str, str]]:
    """The document's example lines: the arrow before each, and the line itself."""
    return re.findall(r"^(->|<-) (\{.*\})$", PROTOCOL.read_text(), re.MULTILINE)


def test_every_example_in_the_protocols_document_decodes() -> None:
    examples_found = document_lines()
    assert len(examples_found) > 30
    for arrow, line in examples_found:
        decoded = ARROWS[arrow](line.encode())
        assert isinstance(decoded, msgspec.Struct), line


def test_the_document_shows_every_request_and_every_answer_of_the_core() -> None:
    shown = {
        (arrow, codec.decode_unknown(line.encode())["kind"]) for arrow, line in document_lines()
    }
    wanted = {("->", kind.__struct_config__.tag) for kind in r.REQUESTS}
    wanted |= {("<-", kind.__struct_config__.tag) for kind in r.ANSWERS}
    assert wanted <= shown, (
        f"docs/reference/protocol.md has no line of {sorted(map(str, wanted - shown))}"
    )


def test_the_commands_in_the_document_send_requests() -> None:
    sent = re.findall(r"'(\{\"kind\":[^'\n]*\})'", PROTOCOL.read_text())
    assert len(sent) >= 5
    for line in sent:
        codec.decode_request(line.encode())


def test_the_python_example_talks_to_a_socket(tmp_path: Path) -> None:
    [program] = re.findall(r"```python\n(.*?)```", PROTOCOL.read_text(), re.DOTALL)
    path = tmp_path / "robot.sock"
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(path))
        listener.listen()
        listener.settimeout(20)
        child = subprocess.Popen(
            [sys.executable, "-c", program],
            env={**os.environ, "WOZ_SOCKET": str(path)},
            stdout=subprocess.PIPE,
            text=True,
        )
        with child, listener.accept()[0] as robot, robot.makefile("rb") as lines:
            robot.settimeout(20)
            requests = [codec.decode_request(lines.readline()) for _ in range(2)]
            robot.sendall(codec.encode(ActionDone(run="r1", action="Hello")))
            robot.shutdown(socket.SHUT_RDWR)
            said, _ = child.communicate(timeout=20)
    assert requests == [
        Hello(role="program", protocol=PROTOCOL_VERSION, stream="actions"),
        AskAction(ref=1, action="Hello"),
    ]
    assert said.split() == ["action.done", "Hello"]
