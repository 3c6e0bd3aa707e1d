"""A secret in an address is in no log and on no screen, whatever it came by."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from tests.session.engagement_rig import WIZARD, EngagementRig, GuideDriver, guided, in_room
from tests.session.rig import HERE, action, call, together
from woz_tui.config.experiment import Panel
from woz_tui.drivers.contract import DriverError, Job
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.requests import AskVerb, Reply

PICTURE = "http://ada:PASSWORD@host/a.png?size=2&access_token=PASSWORD"
SHOWN = "http://ada:***@host/a.png?size=2&access_token=***"
PROGRAM = RequestOrigin("program", "", "con2")


class Talkative(GuideDriver):
    """Repeats what it was given, by every way that a driver has."""

    async def perform(self, job: Job) -> Mapping[str, Json]:
        text = " ".join(map(str, job.args.values()))
        self.context.notice("warning", f"slow: {text}", f"try {text}")
        self.context.reading("identity", 1.0, text=text)
        self.context.sensor("identity", "stale", text)
        job.mark("word", text)
        if job.verb == "sound":
            raise DriverError(f"cannot fetch {text}", f"open {text}")
        return await super().perform(job)


def test_no_way_brings_a_password_into_the_log_or_the_stream(tmp_path: Path) -> None:
    lines: list[bytes] = []
    key = action("Shows", together(call("screen", file=PICTURE)))

    async def scenario(rig: EngagementRig) -> None:
        session = rig.session
        stream = session.hub.subscribe(10_000, True, lambda: None)
        await asyncio.sleep(0)
        for verb, args in (
            ("screen", {"file": PICTURE}),
            ("sound", {"file": PICTURE}),
            ("say", {"text": f"Look at {PICTURE}"}),
            ("say", {"txet": PICTURE}),
            ("gaze", {"yaw": PICTURE}),
            ("eyes", {PICTURE: "red"}),
            ("mark", {"text": PICTURE}),
        ):
            session.send(verb, args, "", PROGRAM)
        session.play("Shows", WIZARD)
        session.note(f"seen at {PICTURE}")
        session.mark(PICTURE, "wizard")
        with contextlib.suppress(RequestError):
            session.send(PICTURE, {}, "", PROGRAM)
        await asyncio.sleep(3.0)
        lines.extend(stream.take_all())

    made = guided(tmp_path)
    experiment = replace(
        made,
        panels=(*made.panels, Panel("Faces", (key,), HERE)),
        files=(tmp_path / "made.yaml",),
        texts=(f"screen: {PICTURE}\n",),
    )
    rig = in_room(tmp_path, scenario, experiment, kind=Talkative)
    log = b"".join(path.read_bytes() for path in tmp_path.rglob("*.jsonl"))
    for told in (log, b"".join(lines)):
        assert SHOWN.encode() in told
        assert b"PASSWORD" not in told
    assert ("screen", {"file": PICTURE}) in rig.robot.calls, "the robot needs it to fetch it"
    assert len([line for line in rig.of(m.Note) if line.text]) == 1


def test_an_answer_has_none_and_a_request_arrives_as_it_is() -> None:
    reply: Any = codec.encode(Reply(ref=1, ok=False, reason=f"no file {PICTURE}", data=[PICTURE]))
    assert b"PASSWORD" not in reply
    assert reply.count(SHOWN.encode()) == 2
    request = AskVerb(verb="screen", args={"file": PICTURE})
    assert codec.decode_request(codec.encode(request)) == request


def test_other_texts_are_told_as_they_are() -> None:
    note = m.Note(text="http://host:80/a@2x.png, anna:berta@example.org", seq=1, t=2, ts="")
    assert codec.decode_message(codec.encode(note)) == note
