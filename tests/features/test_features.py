"""What features may do to a session, and what they cannot."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from woz_tui.feature import PIECES, answer_of, answers_of, features, left_out, pieces
from woz_tui.gate.questions import ClientRequest, PlayEffect
from woz_tui.gate.table import TABLE, FeatureGate, FeatureRow, Row, all_rows, stop_pressed
from woz_tui.protocol.kinds import FeatureKinds, message_kinds, request_kinds

ROOT = Path(__file__).parents[2]

#: Features of somebody else: one that cannot be imported, and one that fails in a session.
STRANGERS = """
from woz_tui.drivers.contract import Verb
from woz_tui.feature import Feature, PerformerName
from woz_tui.gate.questions import PlayAction
from woz_tui.gate.table import FeatureGate, FeatureRow, Row
from woz_tui.protocol.envelope import Message
from woz_tui.protocol.kinds import FeatureKinds
from woz_tui.protocol.messages import ActionRequested
from woz_tui.session.session_features import PerformingFeature, SessionFeature


class Secret(Message, frozen=True, kw_only=True, tag="secret"):
    text: str = ""


class FailsInSession(PerformingFeature):
    verbs = (Verb("shine", "Shine."),)

    async def perform(self, job):
        return {"shone": 1}

    async def stop(self, scope):
        pass

    def hear(self, message):
        raise ZeroDivisionError("the feature's own")

    def fact(self):
        return "a full moon"

    def idle(self):
        return True  # it is not: it has a fact

    hears = {ActionRequested: hear}


def full_moon(facts, asked):
    raise KeyError("moon")


class Failing(Feature):
    name = "failing"
    performer = PerformerName("moon", "the moon")
    kinds = "__init__:KINDS"
    session = "__init__:FailsInSession"
    gate = "__init__:GATE"


KINDS = FeatureKinds(messages=(Secret,))
GATE = FeatureGate(rows=(FeatureRow(Row("moon", (PlayAction,), full_moon)),))


class Absent(Feature):
    name = "absent"
    session = "nowhere:Nothing"


class NoFeature:
    pass


class Note(Message, frozen=True, kw_only=True, tag="note"):
    text: str = ""


class Twice(Feature):
    name = "twice"
    kinds = "__init__:NOTES"


class NeverUsed(SessionFeature):
    def __init__(self, session):
        raise AssertionError("nothing of it would be forbidden")


class Ungated(Feature):
    name = "ungated"
    gate = "nowhere:GATE"
    session = "__init__:NeverUsed"


NOTES = FeatureKinds(messages=(Note,))
"""
SESSION = """
import asyncio, sys
from pathlib import Path
from tests.session.rig import SessionRig
from woz_tui.feature import left_out
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.redactor import Redactor
from strangers import Secret

async def shine(rig):
    number = f"c{len(rig.of(m.Command))}"
    command = m.Command(
        command=number, run="", driver="moon", verb="shine", args={}, source="test"
    )
    ended = (m.Done, m.Refused)
    before = len(rig.of(*ended))
    rig.session.bus.submit(command)
    await rig.until(lambda: len(rig.of(*ended)) > before)
    last = rig.of(*ended)[-1]
    print("shine", last.reason if isinstance(last, m.Refused) else "done")

async def scenario(rig):
    await shine(rig)
    for name in ("Hello", "Map"):
        try:
            rig.session.play(name, RequestOrigin("key", "h", "con1"))
            print("played", name)
        except RequestError as error:
            print("refused", name, error.reason)
    await shine(rig)

rig = SessionRig(Path(sys.argv[1])).run(scenario, 3)
print("notices", [each.text for each in rig.of(m.Notice) if each.level == "error"])
print("ended", rig.of(m.SessionEnd)[0].reason)
print("left out", sorted(left_out()))
"""


def installed(folder: Path, package: str, *points: str, **modules: str) -> dict[str, str]:
    """The environment of a Python in which this package of somebody else is installed: its entry
    points, and its modules by name.
    """
    (folder / f"{package}-1.0.dist-info").mkdir(parents=True)
    (folder / package).mkdir()
    for name, text in modules.items():
        (folder / package / f"{name}.py").write_text(text)
    info = folder / f"{package}-1.0.dist-info"
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("\n".join(("[woz_tui.features]", *points)) + "\n")
    return os.environ | {"PYTHONPATH": str(folder)}


def python(environment: dict[str, str], *words: str) -> subprocess.CompletedProcess[str]:
    """What a Python there says."""
    return subprocess.run(
        [sys.executable, *words],
        capture_output=True,
        text=True,
        timeout=100,
        env=environment,
        cwd=ROOT,
        check=False,
    )


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    """One in which the features of somebody else are installed."""
    points = (
        *("failing = strangers:Failing", "absent = strangers:Absent", "no = strangers:NoFeature"),
        *("twice = strangers:Twice", "ungated = strangers:Ungated"),
    )
    return installed(tmp_path / "site", "strangers", *points, __init__=STRANGERS)


def test_a_feature_that_fails_is_named_and_the_session_goes_on(
    tmp_path: Path, environment: dict[str, str]
) -> None:
    done = python(environment, "-c", SESSION, str(tmp_path))
    assert done.returncode == 0, done.stderr
    told = done.stdout.splitlines()
    assert told.pop(0) == "shine done"
    assert told.pop(2) == "shine moon does not offer 'shine'"
    # Its row forbids while it fails; then the feature itself fails, and its row forbids no more.
    assert told[0].startswith("refused Hello the check of 'moon' failed")
    assert told[1] == "played Map"
    assert "failing failed and is not used any more (ZeroDivisionError)" in told[2]
    assert told[3].startswith("ended")
    assert "absent" in told[4]
    assert "strangers:NoFeature" in told[4]
    assert "twice" in told[4], "its kind of message means something else already"
    assert "ungated" in told[4]
    assert "AssertionError" not in told[2]


def test_a_row_of_which_no_moment_is_known_is_one_that_only_a_session_knows(
    environment: dict[str, str],
) -> None:
    words = ("-m", "woz_tui", "check", "experiments/demo.yaml", "--why", "h")
    told = python(environment, *words).stdout
    [last] = [line for line in told.splitlines() if line.startswith("only a session knows:")]
    assert "moon" in last.split(": ")[1].split(", ")
    assert "profile" not in last


#: A feature that forbids what drives, from the first marker on.
NIGHT = """
from woz_tui.feature import Feature
from woz_tui.gate.questions import DispatchCommand, SubmitCommand
from woz_tui.gate.table import FeatureGate, FeatureRow, Row, not_watched
from woz_tui.protocol.messages import Marker
from woz_tui.protocol.refusal import Refusal
from woz_tui.session.session_features import SessionFeature


class InSession(SessionFeature):
    dark = False

    def hear(self, marker):
        self.dark = True

    def fact(self):
        return "night" if self.dark else None

    hears = {Marker: hear}


def dark(facts, asked):
    return Refusal("night", "it is dark") if asked.verb.drives else None


class Night(Feature):
    name = "night"
    session = "__init__:InSession"
    gate = "__init__:GATE"


ROW = Row("night", (SubmitCommand, DispatchCommand), dark)
GATE = FeatureGate(rows=(FeatureRow(ROW, before=not_watched),))
"""
DRIVES = """
import asyncio, sys
from pathlib import Path
from tests.session.rig import SessionRig
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m

KEY = RequestOrigin("key", "h", "con1")

async def scenario(rig):
    for _ in range(2):
        rig.session.send("drive", {"x": 1.0}, "", KEY, when_busy="queue")
    await asyncio.sleep(1)
    rig.session.hub.publish(m.Marker(text="sunset"))
    rig.session.send("drive", {"x": 1.0}, "", KEY)
    rig.session.send("play", {"move": "nod"}, "", KEY)

rig = SessionRig(Path(sys.argv[1])).run(scenario, 12)
print(*[f"{line.command} {line.code} {line.reason}" for line in rig.of(m.Refused)], sep="\\n")
print(*[line.command for line in rig.of(m.Done)])
"""


@pytest.mark.safety
def test_a_row_about_commands_is_asked_on_their_way_and_again_before_the_driver(
    tmp_path: Path,
) -> None:
    site = installed(tmp_path / "site", "night", "night = night:Night", __init__=NIGHT)
    done = python(site, "-c", DRIVES, str(tmp_path))
    assert done.returncode == 0, done.stderr
    on_its_way, waited, ended = done.stdout.splitlines()
    assert on_its_way == "c00003 night it is dark"
    assert waited == "c00002 night it is dark"
    assert ended == "c00004 c00001", "what drives already, and what does not"


def test_a_row_that_nobody_would_ask_is_none() -> None:
    for kind in (ClientRequest, PlayEffect):
        with pytest.raises(ValueError, match=f"not asked about {kind.__name__}"):
            FeatureGate(rows=(FeatureRow(Row("weather", (kind,), stop_pressed)),))


def test_doctor_names_what_is_missing(environment: dict[str, str]) -> None:
    told = python(environment, "-m", "woz_tui", "doctor", "--json").stdout
    found = {
        each["subject"]: (each["level"], each["text"])
        for each in json.loads(told)["findings"]
        if each["subject"].startswith("feature ")
    }
    assert found["feature failing"] == ("ok", "of the package strangers")
    level, text = found["feature absent"]
    assert (level, "session: ModuleNotFoundError" in text) == ("error", True)
    level, text = found["feature strangers:NoFeature"]
    assert (level, "no Feature" in text) == ("error", True)
    assert found["feature ungated"][1].startswith("gate: ModuleNotFoundError")


FILE = """
import sys
from pathlib import Path
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed

try:
    load(Path(sys.argv[1]), installed())
except ExperimentError as error:
    print(*error.problems, sep="\\n")
"""
MOONS = """
from woz_tui.feature import Feature


class Moons(Feature):
    name = "moons"
    section = "section:SECTION"
"""
READER = """
from dataclasses import dataclass
from woz_tui.config.feature_section import FeatureSection


@dataclass(frozen=True, kw_only=True)
class Keys:
    moons: int = 0


class Fails(FeatureSection):
    def read(self, table, file, contents):
        raise ZeroDivisionError(file.moons)


SECTION = Fails(Keys, 0)
"""


def test_a_feature_that_fails_with_a_file_is_told_as_its_mistake(tmp_path: Path) -> None:
    moons = {"__init__": MOONS, "section": READER}
    site = installed(tmp_path / "site", "moons", "moons = moons:Moons", **moons)
    done = python(site, "-c", FILE, str(ROOT / "experiments" / "guide.yaml"))
    assert done.returncode == 0, done.stderr
    (problem,) = done.stdout.splitlines()
    assert "guide.yaml:" in problem
    assert "the feature 'moons' fails with this file: ZeroDivisionError" in problem


GERMAN = """
from woz_tui.config.screen_language import say, use

use("de")
print(say("moons.full", "the moon is full"))
print(say("moons.new", "the moon is new"))
print(say("gate.ending", "the session is ending"))
"""


@pytest.mark.parametrize("broken", [False, True])
def test_a_feature_of_others_brings_its_german(tmp_path: Path, broken: bool) -> None:
    moons = {"__init__": f"{MOONS}    translations = 'words'\n", "section": READER}
    site = installed(tmp_path / "site", "moons", "moons = moons:Moons", **moons)
    words = tmp_path / "site" / "moons" / "words"
    words.mkdir()
    german = "moons:\n  full: Vollmond\ngate:\n  ending: etwas anderes\n"
    (words / "de.yaml").write_text("moons: [" if broken else german)
    done = python(site, "-c", GERMAN)
    assert done.returncode == 0, done.stderr
    full = "the moon is full" if broken else "Vollmond"
    assert done.stdout.splitlines() == [full, "the moon is new", "die Sitzung wird gerade beendet"]


@pytest.mark.parametrize("keys", ["", '[{"id": "moons"}]', "[}"])
def test_keys_that_cannot_be_read_leave_the_consoles_own(tmp_path: Path, keys: str) -> None:
    moons = {"__init__": f"{MOONS}    keys = 'keys.json'\n", "section": READER}
    site = installed(tmp_path / "site", "moons", "moons = moons:Moons", **moons)
    if keys:
        (tmp_path / "site" / "moons" / "keys.json").write_text(keys)
    script = (
        "from woz_tui.config.keys import BUILTIN_KEYS; from woz_tui.feature import left_out;"
        "print([key.id for key in BUILTIN_KEYS][0], *left_out())"
    )
    done = python(site, "-c", script)
    assert (done.returncode, done.stdout.split()) == (0, ["stop", "moons"]), done.stderr


GUARDED = {
    "__init__": """
from woz_tui.feature import Feature


class Guarded(Feature):
    name = "guarded"
    section = "section:SECTION"
    gate = "gate:GATE"
    session = "nowhere:Nothing"
""",
    "section": """
from dataclasses import dataclass
from woz_tui.config.feature_section import FeatureSection


@dataclass(frozen=True, kw_only=True)
class Keys:
    guarded: int = 0


class Section(FeatureSection):
    def read(self, table, file, contents):
        return file.guarded


SECTION = Section(Keys, 0)
""",
    "gate": "from woz_tui.gate.table import FeatureGate\n\nGATE = FeatureGate()\n",
}
#: Its part in a session raises when it is made.
RAISING = """
from woz_tui.session.session_features import SessionFeature


class Raising(SessionFeature):
    def __init__(self, session):
        raise ZeroDivisionError
"""
READ = """
import sys
from pathlib import Path
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.host.robot_process import check_guards

for file in sys.argv[1:]:
    try:
        check_guards(load(Path(file), installed()))
    except ExperimentError as error:
        print(*error.problems, sep="\\n")
    else:
        print("begins")
"""


@pytest.mark.safety
def test_no_session_begins_where_what_the_file_forbids_cannot_be_forbidden(tmp_path: Path) -> None:
    folder = tmp_path / "site"
    site = installed(folder, "guarded", "guarded = guarded:Guarded", **GUARDED)
    plain, used = tmp_path / "plain.yaml", tmp_path / "used.yaml"
    panels = "panels: [{title: Speech, actions: [{key: h, label: Hello, say: Hello}]}]"
    plain.write_text(f"title: Guide\nrobot: simulated\n{panels}\n")
    used.write_text(f"{plain.read_text()}guarded: 1\n")

    words = ("-m", "woz_tui", "host", str(used), "--recordings", str(tmp_path / "recordings"))
    done = python(site, "-c", READ, str(plain), str(used))
    assert done.returncode == 0, done.stderr
    first, second = done.stdout.splitlines()
    assert first == "begins", "the file does not use it"
    assert "used.yaml:1:1: guarded: the feature cannot be used" in second
    assert "ModuleNotFoundError" in second
    host = python(site, *words)
    assert host.returncode == 1
    assert "guarded: the feature cannot be used" in host.stderr
    assert not (tmp_path / "recordings").exists()

    (folder / "guarded" / "part.py").write_text(RAISING)
    text = GUARDED["__init__"].replace("nowhere:Nothing", "part:Raising")
    (folder / "guarded" / "__init__.py").write_text(text)
    host = python(site, *words)
    assert host.returncode == 1
    assert "guarded failed and cannot begin" in host.stderr


def test_none_of_ours_is_left_out_and_each_piece_is_what_its_room_uses() -> None:
    for name in PIECES:
        pieces(name, object)
    assert left_out() == {}
    assert all(each.name for each in features().values())


def test_rows_of_features_stand_in_the_order_that_they_name() -> None:
    rows = all_rows()
    assert [row for row in rows if not row.feature] == [*TABLE]
    for gate in pieces("gate", FeatureGate).values():
        for each in gate.rows:
            at = next(at for at, row in enumerate(rows) if row.why_not is each.row.why_not)
            about = {*each.row.about}
            later = [row.why_not for row in rows[at:] if about & {*row.about}]
            assert each.before is None or each.before in later


@pytest.mark.parametrize("feature", pieces("kinds", FeatureKinds))
def test_messages_of_features_are_known_and_what_is_open_is_one_of_them(feature: str) -> None:
    kinds = pieces("kinds", FeatureKinds)[feature]
    assert {*kinds.messages} <= {*message_kinds()}
    assert {*kinds.requests} <= {*request_kinds()}
    assert {*kinds.open} <= {*kinds.messages}


def test_a_piece_that_raises_is_named_and_asked_no_more(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def painted(what: str) -> str:
        asked.append(what)
        if what == "broken":
            raise ZeroDivisionError("in a status row")
        return what

    monkeypatch.setattr("woz_tui.feature._LEFT_OUT", {})
    assert answer_of("sun", "", painted, "well") == "well"
    assert answer_of("sun", "", painted, "broken") == ""
    assert answer_of("sun", "", painted, "well") == ""
    assert answer_of("moon", "", painted, "well") == "well"
    assert asked == ["well", "broken", "well"]
    assert left_out() == {"sun": "ZeroDivisionError: in a status row"}


def test_what_a_piece_makes_one_by_one_may_fail_half_way(monkeypatch: pytest.MonkeyPatch) -> None:
    def found(last: int) -> Iterator[int]:
        yield 1
        yield 10 // last

    monkeypatch.setattr("woz_tui.feature._LEFT_OUT", {})
    assert answers_of("sun", found, 5) == [1, 2]
    assert answers_of("sun", found, 0) == []
    assert answers_of("sun", found, 5) == []
    assert list(left_out()) == ["sun"]
