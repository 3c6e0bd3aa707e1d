"""`woz export --to mcap`, read back by the format's own reader."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from mcap.reader import make_reader

from tests.export import secret_log as told_secrets
from tests.export.export_runs import course_to, export_logs
from tests.export.logs import BEGIN, STEM, Timed, speak, start, visit, write
from tests.export.secret_log import Secrets
from woz_tui.export.log_sources import ExportError
from woz_tui.protocol import messages as m

ZERO_NS = round(BEGIN.timestamp()) * 1_000_000_000


class Recording:
    """What a file holds: messages by topic with their times, schemas, attachments, metadata."""

    def __init__(self, path: Path) -> None:
        self.messages: dict[str, list[tuple[int, dict[str, Any]]]] = {}
        self.schemas: dict[str, tuple[str, dict[str, Any]]] = {}
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            for schema, channel, message in reader.iter_messages(log_time_order=True):
                assert schema is not None
                assert (channel.message_encoding, schema.encoding) == ("json", "jsonschema")
                assert message.log_time == message.publish_time
                self.schemas[channel.topic] = schema.name, json.loads(schema.data)
                line = (message.log_time, json.loads(message.data))
                self.messages.setdefault(channel.topic, []).append(line)
            self.attachments = {each.name: each.data for each in reader.iter_attachments()}
            self.metadata = {each.name: each.metadata for each in reader.iter_metadata()}
            summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert summary.statistics.message_count == sum(map(len, self.messages.values()))

    def check(self) -> None:
        """Every message is what its schema says."""
        for topic, messages in self.messages.items():
            validator = Draft202012Validator(self.schemas[topic][1])
            for _, message in messages:
                validator.validate(message)


def recording(folder: Path, course: list[Timed], **options: object) -> Recording:
    return Recording(course_to(folder, "mcap", course, **options) / f"{STEM}.mcap")


def test_every_line_of_the_log_stands_on_the_channel_of_its_kind(tmp_path: Path) -> None:
    made = recording(tmp_path, visit(), samples=True)
    made.check()
    log = tmp_path / "recordings" / f"{STEM}.jsonl"
    lines = [json.loads(line) for line in log.read_bytes().splitlines()]
    wanted = Counter(f"/woz/{line['kind'].replace('.', '/')}" for line in lines)
    assert wanted == {
        topic: len(messages)
        for topic, messages in made.messages.items()
        if topic.startswith("/woz/") and not topic.startswith("/woz/sensor/")
    }
    (at, marker), *_ = made.messages["/woz/marker"]
    assert at == ZERO_NS + 6_200_000_000
    assert marker["text"] == "=1+1"
    distances = [message.get("value") for _, message in made.messages["/woz/sensor/distance"]]
    assert distances == [1.25, None]


def test_schemas_list_the_fields_that_viewers_offer(tmp_path: Path) -> None:
    made = recording(tmp_path, visit(), samples=True)
    name, schema = made.schemas["/woz/sensor/distance"]
    assert name == "woz.sample"
    assert {"value", "unit", "t"} <= schema["properties"].keys()


def test_what_happened_is_a_log_in_words_and_joints_are_in_radians(tmp_path: Path) -> None:
    course: list[Timed] = [
        *((0, start()), (1, m.reading("left.joint.pan", 90.0, unit="°", driver="left.body"))),
        *((1.5, m.reading("joint.tilt", -45.0, unit="°")), *visit()[6:16]),
    ]
    made = recording(tmp_path, course, samples=True)
    told = [(line["level"], line["message"]) for _, line in made.messages["/log"]]
    assert any(level == 2 and "Hello" in words for level, words in told)
    assert any(level == 3 and "refused" in words for level, words in told)
    assert made.schemas["/log"][0] == "foxglove.Log"
    (_, pan), (_, tilt) = *made.messages["/left/joints"], *made.messages["/joints"]
    assert pan["joints"] == [{"name": "pan", "position": pytest.approx(math.pi / 2)}]
    assert tilt["joints"] == [{"name": "tilt", "position": pytest.approx(-math.pi / 4)}]
    sliding: list[Timed] = [(0, start()), (1, m.reading("joint.lift", -40.0, unit="mm"))]
    (_, lift), *_ = recording(tmp_path / "mm", sliding, samples=True).messages["/joints"]
    assert lift["joints"] == [{"name": "lift", "position": pytest.approx(-0.04)}]
    assert pan["timestamp"] == {"sec": round(BEGIN.timestamp()) + 1, "nsec": 0}


def test_the_visitor_s_sound_stands_at_its_time(tmp_path: Path) -> None:
    speak(tmp_path / "recordings", "media/1.wav", 2.5, level=7)
    spoken = m.SpeechEnded(
        driver="ears", segment=1, began=3_000_000, ended=5_500_000, file="media/1.wav"
    )
    made = recording(tmp_path, [(0, start()), (6, spoken)])
    blocks = made.messages["/visitor/sound"]
    assert blocks[0][0] == ZERO_NS + 3_000_000_000
    sound = b"".join(base64.b64decode(block["data"]) for _, block in blocks)
    assert sound == (7).to_bytes(2, "little") * 20_000
    assert {(block["format"], block["sample_rate"]) for _, block in blocks} == {("pcm-s16", 8000)}


def test_the_log_is_attached_and_what_tells_the_clock_is_in_the_metadata(tmp_path: Path) -> None:
    clock = {"source": "monotonic", "wall_at_t0": BEGIN.isoformat(), "monotonic_us": 123_456}
    made = recording(tmp_path, [(0, start(clock=clock)), *visit()[1:]])
    log = (tmp_path / "recordings" / f"{STEM}.jsonl").read_bytes()
    assert made.attachments == {f"{STEM}.jsonl": log}
    about = made.metadata["woz"]
    assert about["monotonic_us"] == "123456"
    assert about["sha256"] == hashlib.sha256(log).hexdigest()
    assert about["session"] == "S01"


def test_a_redacted_one_has_no_word_of_anybody_and_no_date(tmp_path: Path) -> None:
    secrets = Secrets()
    log = told_secrets.write(tmp_path / "recordings", secrets)
    for to in ("jsonl", "mcap"):
        export_logs(log, to, tmp_path / to, redact=True, samples=True)
    (path,) = (tmp_path / "mcap").glob("*.mcap")
    made = Recording(path)
    assert made.attachments == {}
    assert made.metadata["woz"]["redacted"] == "true"
    words = json.dumps([made.messages, made.metadata])
    copied = "".join(each.read_text() for each in (tmp_path / "jsonl").glob("*.jsonl"))
    assert secrets.leaked(words) <= secrets.leaked(copied)
    assert min(at for messages in made.messages.values() for at, _ in messages) == 0


def test_lines_of_a_damaged_log_that_have_no_time_are_left_out(tmp_path: Path) -> None:
    log = write(tmp_path / "recordings", visit())
    log.write_bytes(log.read_bytes() + b'{"kind":"segment","file":"x"}\n{"kind":"strange","t":5}\n')
    export_logs(log, "mcap", tmp_path / "out")
    made = Recording(tmp_path / "out" / f"{STEM}.mcap")
    assert "/woz/segment" not in made.messages
    assert "/woz/marker" in made.messages


def test_without_its_package_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    with pytest.raises(ExportError, match=r"woz-tui\[mcap\]"):
        recording(tmp_path, visit())
    assert not (tmp_path / "out-mcap").exists()
