"""`--redact-text`: of every text in every kind of message only codes and labels are left."""

from __future__ import annotations

import gzip
import json
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from tests.export import secret_log as told_secrets
from tests.export.export_runs import export_logs
from tests.export.logs import STEM, Timed, session_of, speak, start, visit, write
from tests.export.secret_log import Secrets
from tests.export.test_csv import read_back
from tests.protocol.examples import messages as examples
from woz_tui.analysis.session_reading import ReportExtras, read_report
from woz_tui.export.export_run import FORMATS
from woz_tui.export.redaction import KEPT_IN, PLACEHOLDER, kept_at, redacted
from woz_tui.features.questionnaires.figures import asked_in
from woz_tui.features.questionnaires.kinds import (
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
)
from woz_tui.log.verify import verify
from woz_tui.protocol import messages as m
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.protocol.welcome import Questionnaire, WelcomeSettings

pytestmark = pytest.mark.safety

GUIDE = Path(__file__).parents[2] / "docs" / "reference" / "redaction.md"
#: What of an item is the researcher's own wording.
_OF_ITEM = (
    *("name", "question", "stem", "ends", "labels.text", "choices.text", "unit", "group"),
    *("does_not_apply", "prefer_not", "only_if.item"),
)
_OF_VERSION = ("title", "introduction", *(f"items.{each}" for each in _OF_ITEM))
#: What the researcher asked, which stays; what people said to it does not. Written down here, not
#: taken from what is tested: whoever keeps more has to say so here.
ASKED = {
    *(("questionnaire.started", "title"), ("questionnaire.answered", "question")),
    *(
        ("session.plan", f"settings.study.questionnaires.{place}")
        for place in (
            *("name", *_OF_VERSION, *(f"versions.{each}" for each in _OF_VERSION)),
            *("scores.name", "scores.items", "scores.reverse", "scores.pairs"),
        )
    ),
}
#: Whatever else is decided one day: these are never left.
NEVER = {
    *("text", "args", "sent", "reason", "remedy", "detail", "why", "question", "title", "about"),
    *("files", "changes", "file", "path", "check", "wall", "ts", "settings", "visitor"),
}


def content(folder: Path) -> str:
    """Everything that stands in the files of a folder, and their names."""
    parts = []
    for path in sorted(folder.rglob("*")):
        parts.append(str(path.relative_to(folder)))
        if path.is_file():
            raw = path.read_bytes()
            parts.append((gzip.decompress(raw) if path.suffix == ".gz" else raw).decode())
    return "\n".join(parts)


def promised() -> set[str]:
    """Fields of which the guide says that their texts stay."""
    section = (
        GUIDE.read_text(encoding="utf-8").split("<!-- kept: begin")[1].split("<!-- kept: end")[0]
    )
    return set(re.findall(r"`([a-z_0-9.]+)`", section))


def field_of(path: str) -> str:
    """As the guide names it: the whole place, the field, or the field and the name within it."""
    if path in promised():
        return path
    first, *inside = path.partition("{")[0].split(".")
    return first if first in promised() or not inside else f"{first}.{inside[-1]}"


@pytest.mark.parametrize("to", FORMATS)
def test_no_secret_of_any_message_gets_out(tmp_path: Path, to: str) -> None:
    secrets = Secrets()
    log = told_secrets.write(tmp_path / "recordings", secrets)
    export_logs(log, to, tmp_path / "out", redact=True, samples=True)
    leaked = secrets.leaked(content(tmp_path / "out"))
    assert {field_of(path) for _, path in leaked} <= promised()
    for field in ("was", "part"):
        kinds = {kind for kind, fields in KEPT_IN.items() if field in fields}
        assert {kind for kind, path in leaked if path == field} <= kinds
    asked = {each for each in leaked if "questionnaires." in each[1]}
    assert asked <= ASKED, "of a questionnaire no more stays than what it asks"
    leaked -= ASKED
    assert not {field_of(path).partition(".")[0] for _, path in leaked} & NEVER
    assert ("strange", "anything") not in leaked


def anna() -> list[Timed]:
    """A session in which everything that has an end ends with a name."""
    item = {"name": "a", "question": "Why?", "text": True}
    answer = QuestionnaireAnswered(questionnaire="q", item="a", question="Why?", text="Anna")
    sent: dict[str, Json] = {"text": "Anna"}
    off: dict[str, Json] = {"run": "off"}
    return [
        (0, start()),
        (1, m.EngagementAdopted(settings={"model": "Anna"})),
        (2, engagement_changed("Wait", "Engaged")),
        (3, m.TrialStarted(trial=1)),
        (3, m.ActionRequested(run="r1", action="Hello", source="key")),
        (3, m.Command(command="c1", run="r1", verb="say", args=sent, source="key")),
        (4, m.Failed(command="c1", reason="Anna")),
        (4, m.ActionFailed(run="r1", action="Hello", reason="Anna")),
        (5, m.SpeechStarted(driver="ears", segment=1, began=5_000_000)),
        (6, m.SpeechEnded(driver="ears", segment=1, began=5_000_000, ended=6_000_000)),
        (6, m.SpeechText(driver="ears", segment=1, text="Anna")),
        (7, m.BreakStarted(text="Anna")),
        (8, m.BreakEnded(text="Anna")),
        (9, m.TrialEnded(trial=1, outcome="done", text="Anna")),
        (10, QuestionnaireStarted(questionnaire="q", title="Mood", items=[item])),
        (11, answer),
        (12, QuestionnaireEnded(questionnaire="q", reason="Anna", answered=1)),
        (13, m.Command(command="c2", verb="run", driver="engagement", args=off, source="key")),
        (14, m.Done(command="c2", driver="engagement", sent=off, latency_us=0, duration_us=0)),
        (15, m.Note(text="Anna")),
    ]


def engagement_changed(was: str, now: str) -> m.EngagementChanged:
    return m.EngagementChanged(was=was, now=now, outcome="went", why="Anna", verdicts={})


@pytest.mark.parametrize("to", FORMATS)
def test_no_end_of_anything_tells_a_secret(tmp_path: Path, to: str) -> None:
    log = write(tmp_path / "recordings", anna())
    export_logs(log, to, tmp_path / "open")
    assert "Anna" in content(tmp_path / "open")
    export_logs(log, to, tmp_path / "out", redact=True)
    assert "Anna" not in content(tmp_path / "out")


@pytest.mark.parametrize("to", FORMATS)
def test_buttons_of_typed_sentences_tell_none(tmp_path: Path, to: str) -> None:
    name = "typed: Come again, Anna"
    button = ActionView(name=name, label=name, utterances=["Anna"], then=[name])
    plan = m.SessionPlan(
        title="", panels=[PanelView(title="Typed", actions=[button])], verbs={}, variables=[],
        conditions=[], keyboard="us", drivers=[], settings=WelcomeSettings(),
    )  # fmt: skip
    course: list[Timed] = [
        (0, start()),
        (1, plan),
        (3, m.ActionRequested(run="r1", action=name, panel="Typed", source="key", key="8")),
        (4, m.ActionDone(run="r1", action=name)),
    ]
    log = write(tmp_path / "recordings", course)
    export_logs(log, to, tmp_path / "out", redact=True)
    found = content(tmp_path / "out")
    assert "Anna" not in found
    assert re.search(r"typed: .?\[redacted", found)


def test_times_are_the_same_with_and_without_texts(tmp_path: Path) -> None:
    """Also of the model, which a redacted word has switched off."""
    plain, published = session_of(tmp_path, anna()), session_of(tmp_path, anna(), redact=True)
    times = [
        [(each.kind, each.label, each.begin, each.end, each.trial) for each in session.events]
        for session in (plain, published)
    ]
    assert times[0] == times[1]
    assert ("engagement", "Engaged", 2_000_000, 14_000_000, None) in times[0]


def test_without_redaction_all_of_it_is_there(tmp_path: Path) -> None:
    """So the search for secrets finds what is there to be found."""
    secrets = Secrets()
    log = told_secrets.write(tmp_path / "recordings", secrets)
    export_logs(log, "jsonl", tmp_path / "out", private=True)
    anew = {("session.start", "format"), ("checkpoint", "sha256"), ("session.end", "sha256")}
    assert secrets.leaked(content(tmp_path / "out")) == set(secrets.told.values()) - anew
    export_logs(log, "csv", tmp_path / "csv", samples=True)
    texts = {path for kind, path in secrets.leaked(content(tmp_path / "csv")) if kind == "note"}
    assert texts == {"text", "tells", "console"}


def test_the_copy_of_a_log_has_all_that_is_promised(tmp_path: Path) -> None:
    secrets = Secrets()
    log = told_secrets.write(tmp_path / "recordings", secrets)
    export_logs(log, "jsonl", tmp_path / "out", redact=True)
    leaked = {path for _, path in secrets.leaked(content(tmp_path / "out"))}
    fixed = {place for places in kept_at().values() for place in places}  # no secret is such a word
    of_study = {each for each in ASKED if each[0] == "session.plan"}
    assert of_study <= secrets.leaked(content(tmp_path / "out")), "what was asked stays"
    everywhere = {field for field in promised() - fixed if "." not in field}
    assert everywhere - leaked == {"kind", "format", "sha256"}, "fixed, or computed anew"


@pytest.mark.parametrize("to", FORMATS)
def test_no_date_is_left(tmp_path: Path, to: str) -> None:
    log = write(tmp_path / "recordings", visit())
    export_logs(log, to, tmp_path / "out", redact=True, samples=True)
    assert "2026" not in content(tmp_path / "out")
    export_logs(log, to, tmp_path / "dated", samples=True)
    assert "2026" in content(tmp_path / "dated")


@pytest.mark.parametrize("to", ["eaf", "textgrid"])
def test_no_voice_is_left(tmp_path: Path, to: str) -> None:
    speak(tmp_path / "recordings" / f"{STEM}.media", "speech-1.wav", 1)
    file = f"{STEM}.media/speech-1.wav"
    spoken = m.SpeechEnded(driver="ears", segment=1, began=0, ended=1_000_000, file=file)
    log = write(tmp_path / "recordings", [(0, start()), (2, spoken)])
    export_logs(log, to, tmp_path / "out", redact=True)
    assert list((tmp_path / "out").glob("*.wav")) == []
    assert "speech-1" not in content(tmp_path / "out")


def test_a_redacted_log_is_whole_and_says_what_it_is(tmp_path: Path) -> None:
    log = write(tmp_path / "recordings", visit())
    export_logs(log, "jsonl", tmp_path / "out", redact=True)
    copy = tmp_path / "out" / "P07_S01.jsonl"
    assert (
        verify(copy).sentences() == verify(log).sentences() == ["1 request(s) without an end: r3"]
    )
    assert verify(copy).checkpoints == 1
    first = json.loads(copy.read_bytes().splitlines()[0])
    assert (first["redacted"], first["participant"]) == (True, "P07")
    export_logs(log, "jsonl", tmp_path / "plain")
    first = json.loads((tmp_path / "plain" / f"{STEM}.jsonl").read_bytes().splitlines()[0])
    assert first.get("redacted", False) is False


def test_visitors_with_a_name_lose_it() -> None:
    for name, left in (("V012", "V012"), ("", ""), ("Anna", PLACEHOLDER), ("V1 Anna", PLACEHOLDER)):
        line = {"kind": "visitor.changed", "visitor": name, "was": "Anna"}
        assert redacted(line)["visitor"] == left
        assert redacted(line)["was"] == PLACEHOLDER


_JSON = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(), st.text(max_size=5)),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=10,
)
_FIELDS = st.dictionaries(
    st.sampled_from(["text", "args", "action", "verbs", "items", "visitor", "experiment", "new"]),
    _JSON,
)


@given(_FIELDS)
def test_types_stay_as_they_are(fields: dict[str, object]) -> None:
    after = redacted(fields)
    assert list(after) == list(fields)
    for name, value in fields.items():
        if not isinstance(value, dict):
            assert type(after[name]) is type(value)


@given(_FIELDS)
def test_twice_is_as_once(fields: dict[str, object]) -> None:
    assert redacted(redacted(fields)) == redacted(fields)


def test_objects_as_deep_as_a_reader_takes_them_are_no_trouble(tmp_path: Path) -> None:
    args: Json = "secret"
    for _ in range(900):
        args = {"a": args}
    say = m.Command(command="c1", verb="say", args={"a": args}, source="key")
    session = session_of(tmp_path, [(0, start()), (1, say)], redact=True)
    assert "secret" not in str(session.events)


def test_figures_are_the_same_without_words(tmp_path: Path) -> None:
    """Words decide some of them: when the model was off, and what answers a cue."""
    plan = next(each for each in examples() if isinstance(each, m.SessionPlan))
    asked = [Questionnaire("mood", title="Mood", when="end")]
    answers = {"marker": ["Gestures"]}
    study = replace(plan.settings.study, answers=answers, questionnaires=asked)
    off: dict[str, m.Json] = {"run": "off"}
    course: list[Timed] = [
        (0, start()),
        (0, replace(plan, settings=replace(plan.settings, study=study))),
        (0, m.EngagementAdopted(settings={"start": "hold"})),
        (0, m.ConsoleAttached(console="c1", role="wizard", part="Body")),
        (1, m.TrialStarted(trial=1, condition="cold")),
        (2, m.Marker(text="laughs", source="wizard")),
        (
            3,
            m.ActionRequested(run="a1", action="Nod", panel="Gestures", source="key", console="c1"),
        ),
        (4, m.Command(command="c1", verb="run", driver="engagement", args=off, source="key")),
        (4, m.Done(command="c1", driver="engagement", sent=off, latency_us=0, duration_us=0)),
        (7, m.AddressedChanged(driver="eyes", face=1, chosen="hand")),
        (8, m.AddressedChanged(driver="eyes", face=None)),
        (9, m.TrialEnded(trial=1, outcome="done")),
        (9, QuestionnaireStarted(questionnaire="ux", title="UX", items=[])),
        (9, QuestionnaireEnded(questionnaire="ux", reason="declined", answered=0)),
        (9, m.ConsoleLost(console="c1", role="wizard", why="left", part="Body")),
    ]
    log = write(tmp_path / "in", course)
    for name, redact in (("open", False), ("kept", True)):
        export_logs(log, "csv", tmp_path / name, redact=redact)
        export_logs(log, "jsonl", tmp_path / f"{name}-log", redact=redact)
    for table in ("conditions", "actions", "engagement", "wizards"):
        first, second = (
            [{**row, "log": ""} for row in read_back(tmp_path / name / f"{table}.csv")]
            for name in ("open", "kept")
        )
        assert first == second
    rows = read_back(tmp_path / "kept" / "cues.csv")
    assert [(row["label"], row["result"]) for row in rows] == [(PLACEHOLDER, "answered")]
    [cold] = [row for row in read_back(tmp_path / "kept" / "conditions.csv") if row["condition"]]
    assert float(cold["engagement_off_s"]) == 5
    plain, published = (
        read_report(
            tmp_path / f"{name}-log" / f"{stem}.jsonl", extras=ReportExtras(people=True)
        ).figures
        for name, stem in (("open", STEM), ("kept", "P07_S01"))
    )
    assert published.whole == plain.whole
    assert (plain.redacted, published.redacted) == (False, True)
    assert [cue.result for cue in published.cues] == ["answered"]
    assert published.whole.engagement.off_us == 5_000_000
    assert (len(asked_in(plain).unanswered), len(asked_in(published).unanswered)) == (1, 1)
    assert [each.reason for each in asked_in(published).rounds] == ["declined"]
    assert [(each.lost, each.why) for each in published.consoles] == [(False, ""), (True, "left")]
    assert published.addressed == plain.addressed
    assert "Anna" not in content(tmp_path / "kept-log")


def test_nothing_but_words_of_the_program_stays_where_those_decide() -> None:
    sent = redacted({"kind": "command.done", "sent": {"run": "Anna", "text": "off"}})
    assert sent["sent"] == {"run": PLACEHOLDER, "text": PLACEHOLDER}
    assert redacted({"kind": "console.lost", "why": "Anna"})["why"] == PLACEHOLDER
    values = {
        "values": {"when": "Anna"},
        "study": {"answers": {"Anna": ["Anna"], "speech": [["A"]]}},
    }
    plan = redacted({"kind": "session.plan", "settings": values})
    assert "Anna" not in str(plan)
    assert plan["settings"]["study"]["answers"]["speech"] == [[PLACEHOLDER]]
