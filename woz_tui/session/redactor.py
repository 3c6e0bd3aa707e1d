"""What each role may see, decided before a line is sent: docs/reference/roles.md has the table.

Nothing here reads words to find out what they tell. Who makes a message says it: `tells` of a
message with words, `unfilled` of a command, `telling` of a reload.

A wizard and a watcher are blind to the condition where the experiment says so, and do not see what
`perception` keeps from them. A participant gets the course of the study, and what features name.
A program sees all.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import PurePath
from typing import Any, ClassVar

import msgspec
from msgspec.structs import fields, replace

from woz_tui.config.engagement_words import STATES
from woz_tui.config.study_words import BLURRED, PERCEIVED
from woz_tui.config.utterance_template import OF_VISITOR
from woz_tui.feature import features, pieces
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol import welcome as s
from woz_tui.protocol.kinds import (
    FeatureKinds,
    closed_kinds,
    participant_kinds,
    participant_words,
)
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence, wording_of
from woz_tui.sensing.sample_values import ZONES

log = logging.getLogger(__name__)

#: What stands in the place of something hidden.
HIDDEN = "hidden"
#: What stands for a notice that tells something which is kept, by its level, and for a reason.
_WARNING_KEPT = Sentence(
    "session.warning_kept",
    "this warning is not shown: it could reveal what this study hides from you",
)
_ERROR_KEPT = Sentence(
    "session.error_kept",
    "this error is not shown: it could reveal what this study hides from you",
)
_REASON_KEPT = Sentence(
    "session.reason_kept",
    "the reason is not shown: it could reveal what this study hides from you",
)
#: How a sign of the engagement model says that it is hidden, or only known coarsely.
KEPT, COARSE = "hidden", "blurred"
#: What a message may tell to which a wizard is blind.
_CONDITION = frozenset({"condition", "request"})
#: The signs of the engagement model among what can be hidden.
_SIGNS = ("presence", "gaze", "distance", "identity")
#: Blurred, a distance is near up to the end of personal space (`sensing.sample_values`), in metres.
NEAR_M = next(limit for limit, name in ZONES if name == "personal")
#: Blurred, a loudness is loud from the threshold of speech on; without one from here (RMS).
LOUD = 0.02
#: Blurred, what was said is as many dots as it has more words than these.
_WORDS = (0, 3, 10)
_DOT = "●"
#: Characters from which on a text says by itself whose it is.
_LONG = 4
#: Values of a body that its face shows.
_FACE = frozenset(("emotion", "intensity", "valence", "arousal", "eye_x", "eye_y"))
#: Settings of a robot that its face shows.
_EYES = frozenset(("eyes", "eyes_brightness"))

#: What of a message that tells something is no words, but a code, a name or one of few values; all
#: other texts are words.
NAMES = frozenset(
    (
        *("ts", "driver", "source", "console", "key", "level", "code", "outcome", "sort", "block"),
        *("run", "action", "panel", "command", "verb", "when_busy", "by", "original_command"),
        *("sha256", "evidence", "slot", "keep", "participant"),
    )
)
#: What the ear finds out.
_HEARD = ("transcript", "loudness", "presence", "identity")
#: What a participant's terminal gets of the stream, beside what features name.
_FOR_PARTICIPANT = (
    *(m.SessionStart, m.SessionChanged, m.SessionEnd, m.ConditionsAssigned),
    *(m.TrialStarted, m.TrialEnded, m.BreakStarted, m.BreakEnded),
    *(m.StopPressed, m.StopConfirmed, m.StopReleased),
)


@dataclass(init=False)
class PerceptionFilter:
    """What is not shown (`hidden`), or not legibly (`blurred`): see `config.study`."""

    hidden: frozenset[str]
    blurred: frozenset[str]

    def __init__(self, hidden: Iterable[str] = (), blurred: Iterable[str] = ()) -> None:
        self.hidden = frozenset(hidden) & frozenset(PERCEIVED)
        self.blurred = (frozenset(blurred) & frozenset(BLURRED)) - self.hidden

    def __bool__(self) -> bool:
        """Whether anything is kept from the wizard."""
        return bool(self.hidden or self.blurred)

    @classmethod
    def of(cls, study: s.StudySettings) -> PerceptionFilter:
        """As the settings of a study have it."""
        return cls(study.perception.hide, study.perception.blur)

    def hides(self, what: str) -> bool:
        """Whether it is not shown at all."""
        return what in self.hidden

    def blurs(self, what: str) -> bool:
        """Whether it is shown, but not legibly."""
        return what in self.blurred

    def keeps(self, *names: str) -> bool:
        """Whether any of these is not shown as it is."""
        return any(name in self.hidden or name in self.blurred for name in names)


@dataclass(frozen=True, slots=True)
class FeatureRedaction:
    """What is left of a feature's messages where perception is restricted, by their kind; None:
    nothing. Those that may not be seen by others either way are not `open` (see `FeatureKinds`).
    """

    perceived: Mapping[type[m.Message], Callable[[Any, PerceptionFilter], m.Message | None]]


@cache
def _redactions() -> dict[type[m.Message], Callable[[Any, PerceptionFilter], m.Message | None]]:
    of_features = pieces("redaction", FeatureRedaction).values()
    return {kind: hide for each in of_features for kind, hide in each.perceived.items()}


@cache
def _unredacted() -> frozenset[type[m.Message]]:
    """Kinds of features whose redaction cannot be loaded: nobody knows what they tell."""
    there, kinds = pieces("redaction", FeatureRedaction), pieces("kinds", FeatureKinds)
    lacking = [name for name, each in features().items() if each.redaction and name not in there]
    return frozenset(kind for name in lacking if name in kinds for kind in kinds[name].messages)


class Redactor:
    """A wizard's and a watcher's view of a session.

    `apply` every message in its order, whoever sees it; `message`, `welcome`, `panels` and `reply`
    give what the role may have.
    """

    #: What `apply` reads.
    READS: ClassVar[tuple[type[m.Message], ...]] = (
        *(m.Reading, m.Command, m.SessionPlan, m.PerceptionChanged),
    )

    def __init__(self, study: s.StudySettings | None = None) -> None:
        self.perception = PerceptionFilter()
        self._labels: dict[str, str] = {}
        self._names: dict[str, str] = {}
        self._loud_from: dict[str, float] = {}
        #: Texts that depend on the condition and that a driver has got.
        self._given: set[str] = set()
        if study is not None:
            self.adopt(study)

    def __bool__(self) -> bool:
        """Whether anything is kept."""
        return self.blind or bool(self.perception)

    @property
    def blind(self) -> bool:
        """Whether the condition is kept."""
        return bool(self._labels)

    def may_hear(self, *, words_tell: bool) -> bool:
        """Whether live sound tells nothing that is kept. `words_tell`: what the robot says depends
        on the condition.
        """
        return not self.perception.keeps(*_HEARD) and not (self.blind and words_tell)

    def adopt(self, study: s.StudySettings) -> None:
        """From here on this is kept."""
        self.perception = PerceptionFilter.of(study)
        if self._labels != (labels := _unique(study.blind)):
            self._labels = labels
            self._names = {label: name for name, label in labels.items()}

    def apply(self, message: m.Message) -> None:
        match message:
            case m.Reading(sensor=sensor, value=float(value)) if sensor.endswith(".threshold"):
                self._loud_from[sensor.removesuffix(".threshold")] = value
            case m.Command(tells=tells) if "condition" in tells:
                self._given.update(_texts([message.args.get(name) for name in message.unfilled]))
            case m.SessionPlan(settings=settings):
                self.adopt(settings.study)
            case m.PerceptionChanged(hidden=hidden, blurred=blurred):
                self.perception = PerceptionFilter(hidden, blurred)

    # -- conditions ---------------------------------------------------------------------------

    def label(self, condition: str) -> str:
        """What stands for a condition; `?` for one that the file does not name."""
        return self._labels.get(condition, "?") if self.blind and condition else condition

    def labels(self, conditions: Iterable[str]) -> list[str]:
        """The same of several."""
        return [self.label(condition) for condition in conditions]

    def request(self, request: r.Request) -> r.Request:
        """A request with the conditions for which its labels stand."""
        named = getattr(request, request.conditions_in, None) if self.blind else None
        if isinstance(named, str):
            return replace(request, **{request.conditions_in: self._names.get(named, named)})
        if isinstance(named, list):
            names = [self._names.get(label, label) for label in named]
            return replace(request, **{request.conditions_in: names})
        return request

    # -- what is sent beside the stream -----------------------------------------------------------

    def welcome(self, welcome: r.Welcome) -> r.Welcome:
        """Without its messages, which are redacted one by one."""
        seen: r.Welcome = self._shown(welcome, welcome.settings)
        return seen

    def panels(self, changed: r.PanelsChanged) -> r.PanelsChanged:
        """After a reload or a change of profile."""
        study = changed.study or s.StudySettings()
        return replace(
            changed,
            study=changed.study and self._study(study),
            values=self._values(changed.values, study),
            conditions=self.labels(changed.conditions),
        )

    def _shown(self, shown: Any, settings: s.WelcomeSettings) -> Any:
        """A welcome, or a plan."""
        if not self:
            return shown
        values = self._values(settings.values, settings.study)
        settings = replace(settings, study=self._study(settings.study), values=values)
        return replace(shown, conditions=self.labels(shown.conditions), settings=settings)

    def _study(self, study: s.StudySettings) -> s.StudySettings:
        if not self.blind:
            return study
        return replace(
            study,
            blind={label: label for label in self.labels(study.blind)},
            by_condition={name: {} for name in study.by_condition},
            assigned=self.labels(study.assigned),
        )

    def _values(self, values: Mapping[str, str], study: s.StudySettings) -> dict[str, str]:
        """Without what depends on the condition, or on who stands there."""
        seen = dict(values)
        if self.perception.hides("identity"):
            seen = {name: text for name, text in seen.items() if name not in OF_VISITOR}
        if self.blind:
            seen = {name: text for name, text in seen.items() if name not in study.by_condition}
            if "condition" in seen:
                seen["condition"] = self.label(seen["condition"])
        return seen

    def reply(self, reply: r.Reply, instead: Mapping[str, str] | None = None) -> r.Reply:
        """An answer. `instead`: what stands for lines of its data that tell the condition."""
        if not self:
            return reply
        data = reply.data
        if isinstance(data, dict) and "order" in data:  # a proposal
            labels = {
                "order": self.labels(data["order"]),
                "condition": self.label(data["condition"]),
            }
            return replace(reply, data={**data, **labels}) if self.blind else reply
        if isinstance(data, list):
            return replace(reply, data=[self._reply_line(line, instead or {}) for line in data])
        return reply

    def _reply_line(self, line: Json, instead: Mapping[str, str]) -> Json:
        """A difference or an error of the file, or a finding of the preflight."""
        if isinstance(line, dict) and "subject" in line:
            text = str(line.get("text", ""))
            shown = self._finding(str(line["subject"]), text)
            if shown == text:
                return line
            wording = {**line["wording"]} if isinstance(line.get("wording"), dict) else {}
            wording.pop("text", None)
            wording |= msgspec.to_builtins(wording_of({"text": shown}))
            return {**line, "text": str(shown), "wording": wording}
        return instead.get(line, line) if isinstance(line, str) and self.blind else line

    def _finding(self, subject: str, text: str) -> str:
        """What a check found out about `subject`."""
        if self.blind and subject == "experiment":
            return Sentence("session.file_odd", "the file has something odd")
        kind = perceived_kind(subject)
        return (
            Sentence("session.gives_values", "gives values")
            if kind and self.perception.keeps(kind)
            else text
        )

    # -- the stream -------------------------------------------------------------------------------

    def message(self, message: m.Message) -> m.Message | None:
        """A message of the session; None: nothing of it."""
        if type(message) in closed_kinds():
            return None
        seen: m.Message | None = message
        if self.blind:
            change = _BLINDED.get(type(message))
            seen = change(self, message) if change is not None else message
        if isinstance(seen, m.RestrictedMessage):
            seen = self._without_words(seen)
        elif isinstance(seen, m.ActionsFilled):
            seen = self._without_texts(seen)
        if self.perception and seen is not None:
            if self.perception.hides(_SHOWN_WITH.get(type(seen), "")):
                return None
            hide = _PERCEIVED.get(type(seen))
            seen = hide(self, seen) if hide is not None else self._of_feature(seen)
        return seen

    def _of_feature(self, message: m.Message) -> m.Message | None:
        """What a feature leaves of it where perception is restricted; nothing, if that fails."""
        try:
            if type(message) in _unredacted():
                return None
            hide = _redactions().get(type(message))
            return message if hide is None else hide(message, self.perception)
        except Exception:
            log.exception("the redaction of %s failed", type(message).__name__)
            return None

    def _without_words(self, message: m.RestrictedMessage) -> m.Message | None:
        """Without its words, if they tell what is kept."""
        if not message.tells or not any(map(self._keeps, message.tells)):
            return message
        if isinstance(message, m.Command):
            return replace(message, args={**message.args, **message.unfilled})
        if message.kept_whole or (isinstance(message, m.Notice) and message.level == "info"):
            return None
        names = _word_fields(type(message))
        words: Any = dict.fromkeys(names, "")
        if "wording" in message.__struct_fields__:  # code and values of the same words
            words["wording"] = {}
        match message:
            case m.Notice(driver=driver, level=level):
                what = _WARNING_KEPT if level == "warning" else _ERROR_KEPT
                words["text"] = (
                    Sentence("session.of_driver", "{driver}: {what}", driver=driver, what=what)
                    if driver
                    else what
                )
                words["remedy"] = Sentence(
                    "session.read_later", "read it in the log after the session"
                )
            case m.Done():
                words |= {"sent": {}, "duration_us": 0}
            case m.End() | m.ActionEnd():
                words["reason"] = _REASON_KEPT
            case _ if names:
                words[names[0]] = HIDDEN
        return replace(message, **words)

    def _without_texts(self, message: m.ActionsFilled) -> m.Message:
        """Without texts that tell what is kept; it does not say which they are."""
        if not self:
            return message
        actions: Any = {
            name: [
                step if isinstance(step, float | int) else [*map(self._call_without_texts, step)]
                for step in steps
            ]
            for name, steps in message.actions.items()
        }
        return replace(message, actions=actions)

    def _call_without_texts(self, call: m.FilledCall) -> m.FilledCall:
        kept = any(map(self._keeps, call.tells))
        return replace(call, args={**call.args, **call.unfilled}) if kept else call

    def keeps(self, tells: Iterable[str]) -> bool:
        """Whether what tells this may not be seen."""
        return any(map(self._keeps, tells))

    def _keeps(self, what: str) -> bool:
        return self.perception.keeps(what) or (self.blind and what in _CONDITION)

    # -- blind to the condition -------------------------------------------------------------------

    def _condition(
        self, message: m.SessionStart | m.SessionChanged | m.ParticipantWithdrawn | m.TrialStarted
    ) -> m.Message:
        if not message.condition:
            return message
        return replace(message, condition=self.label(message.condition))

    def _assigned(self, message: m.ConditionsAssigned) -> m.Message:
        return replace(message, order=self.labels(message.order))

    def _files(self, message: m.ExperimentFiles) -> None:
        """The experiment's text says which condition is which."""

    def plan(self, message: m.SessionPlan) -> m.SessionPlan:
        """What consoles are shown."""
        plan: m.SessionPlan = self._shown(message, message.settings)
        return plan

    def _reloaded(self, message: m.ExperimentReloaded) -> m.Message:
        changes = [change for change in message.changes if change not in message.telling]
        if len(changes) < len(message.changes):
            changes.append(
                Sentence(
                    "session.other_changes",
                    "other changes, which could reveal the condition",
                )
            )
        return replace(message, changes=changes, telling=[])

    def _shown_values(self, message: m.BodyChanged | m.SettingsShown) -> m.Message:
        """Without values that depend on the condition, as far as the driver got them as texts."""
        if not self._given:
            return message
        shown: Any = {"values": _without(message.values, self._given)}
        if isinstance(message, m.SettingsShown):
            shown["wanted"] = _without(message.wanted, self._given)
        return replace(message, **shown)

    def _face_name(self, message: m.FaceShown) -> m.Message:
        return replace(message, emotion=HIDDEN) if message.emotion in self._given else message

    def _mode(self, message: m.ModeChanged) -> m.Message:
        """Its reason may quote what the driver was given."""
        return replace(message, why="") if self._given else message

    def _plan_perceived(self, message: m.SessionPlan) -> m.Message:
        return message if self.blind else self.plan(message)

    def _checked(self, message: m.PreflightChecked) -> m.Message:
        if message.source != "robot":
            return message
        return replace(message, detail=self._finding(message.check, message.detail))

    # -- sensors ----------------------------------------------------------------------------------

    def _reading(self, message: m.Reading) -> m.Message:
        kind = perceived_kind(message.sensor)
        if self.perception.hides(kind):
            return replace(message, value=None, text="", raw=None, bad=[])
        if self.perception.blurs(kind):
            return replace(message, value=None, text=self._coarse(kind, message), raw=None, bad=[])
        return message

    def _coarse(self, kind: str, reading: m.Reading) -> str:
        if kind == "transcript":
            return dots(reading.text)
        if reading.value is None:
            return ""
        if kind == "distance":
            return "near" if reading.value < NEAR_M else "far"
        loud = reading.value >= self._loud_from.get(reading.sensor, LOUD)
        return "loud" if loud else "quiet"

    def _sensor(self, message: m.SensorChanged) -> m.Message | None:
        kind = perceived_kind(message.sensor)
        if self.perception.hides(kind):
            return None
        return replace(message, why="") if self.perception.blurs(kind) else message

    # -- the engagement model ---------------------------------------------------------------------

    def _model(self, message: m.EngagementShown) -> m.Message:
        signs = {name: self._sign(name, sign) for name, sign in message.signs.items()}
        visitor = "" if self.perception.hides("identity") else message.visitor
        return replace(message, signs=signs, visitor=visitor)

    def _sign(self, name: str, sign: m.SignShown) -> m.SignShown:
        if self.perception.hides(name):
            return m.SignShown(filter=KEPT, forced=sign.forced)
        if self.perception.blurs(name):
            return m.SignShown(
                filter=COARSE, verdict=sign.verdict, stale=sign.stale, forced=sign.forced
            )
        return sign

    def _engaged(self, message: m.EngagementChanged) -> m.Message:
        """Without its reason where that may tell a sign that is kept."""
        if not self.perception.keeps(*_SIGNS, "transcript"):
            return message
        verdicts: dict[str, Json] = {
            name: value
            for name, value in message.verdicts.items()
            if not self.perception.hides("identity" if name == "id" else name)
        }
        visitor = "" if self.perception.hides("identity") else message.visitor
        return replace(message, why="", wording={}, verdicts=verdicts, visitor=visitor)

    def _effect(self, message: m.ActionRequested | m.ActionEnd | m.Command) -> m.Message:
        """What a state of the model brings with it is named after the state."""
        state = message.action.removeprefix("on ")
        if not self.perception.hides("engagement") or state not in STATES:
            return message
        return replace(message, action="on engagement") if state != message.action else message

    def _mode_why(self, message: m.ModeChanged) -> m.Message:
        keeps = self.perception.keeps("engagement", *_SIGNS)
        return replace(message, why="") if keeps else message

    # -- what is said, what the robot looks like --------------------------------------------------

    def _speech_ended(self, message: m.SpeechEnded) -> m.Message | None:
        if self.perception.hides("loudness") and not message.detail:
            return None
        return replace(message, loudest=None) if self.perception.keeps("loudness") else message

    def _speech_text(self, message: m.SpeechText) -> m.Message:
        blurs = self.perception.blurs("transcript")
        return replace(message, text=dots(message.text), words=[]) if blurs else message

    def _body(self, message: m.BodyChanged) -> m.Message:
        if not self.perception.hides("face"):
            return message
        return replace(message, values=_masked(message.values, _FACE))

    def _settings(self, message: m.SettingsShown) -> m.Message:
        if not self.perception.hides("face"):
            return message
        return replace(
            message, values=_masked(message.values, _EYES), wanted=_masked(message.wanted, _EYES)
        )


class CoderRedactor(Redactor):
    """A coder's view of a replay: as of a wizard who is blind to the condition, without a label.

    Labels tell conditions apart, so that who has seen two sessions may guess which is which.
    """

    @property
    def blind(self) -> bool:
        """Always, whatever the wizard knew."""
        return True

    def label(self, condition: str) -> str:
        """What stands for every condition."""
        return HIDDEN if condition else ""


class ParticipantRedactor(Redactor):
    """A participant's view: trials, what features name, the stop; no condition by name."""

    READS = (m.SessionPlan,)

    def __bool__(self) -> bool:
        return True

    def message(self, message: m.Message) -> m.Message | None:
        """A message of the session; None: nothing of it."""
        if not isinstance(message, (*_FOR_PARTICIPANT, *participant_kinds())):
            return None
        match message:
            case m.SessionStart() | m.TrialStarted():
                return replace(message, condition="")
            case m.SessionChanged():
                return replace(message, condition=None)
            case m.ConditionsAssigned(order=order):
                return replace(message, order=_numbered(order), why="", wording={})
            case m.RestrictedMessage() if type(message) not in participant_words():
                return replace(message, **dict.fromkeys(_word_fields(type(message)), ""))
        return message

    def welcome(self, welcome: r.Welcome) -> r.Welcome:
        """What is asked, and when."""
        settings = welcome.settings
        return replace(
            welcome,
            log="",
            panels=[],
            script=[],
            verbs={},
            variables=[],
            conditions=[],
            drivers=[],
            settings=s.WelcomeSettings(
                stale_after=settings.stale_after,
                dead_man=settings.dead_man,
                study=_for_participant(settings.study),
            ),
        )

    def panels(self, changed: r.PanelsChanged) -> r.PanelsChanged:
        """After a reload."""
        return r.PanelsChanged(
            title=changed.title,
            panels=[],
            verbs={},
            conditions=[],
            keyboard=changed.keyboard,
            study=_for_participant(changed.study) if changed.study is not None else None,
        )

    def reply(self, reply: r.Reply, instead: Mapping[str, str] | None = None) -> r.Reply:
        """Those that a participant gets are about what was asked there alone."""
        return reply


def sees_everything(role: str, sees: str) -> bool:
    """Whether nothing is kept from this role. `sees` as in `requests.Hello`."""
    return role == "program" and sees != "wizard"


def perceived_kind(sensor: str) -> str:
    """What a sensor tells, in the words of the experiment file: `left.joint.pan` -> `joints`; a
    sensor that cannot be hidden is empty.
    """
    parts = sensor.split(".")
    if "joint" in parts or "setpoint" in parts:
        return "joints"
    if parts[-1] == m.SPEECH_SENSOR:
        return "transcript"
    return next((part for part in reversed(parts) if part in PERCEIVED), "")


def dots(text: str) -> str:
    """One to three dots for a short, a longer and a long utterance; none for an empty one."""
    words = len(text.split())
    return " ".join(_DOT for more in _WORDS if words > more)


def _masked(values: object, names: Container[str]) -> dict[str, Json]:
    """`values` with the word that they are hidden for those of these names, at any depth."""
    shown = values if isinstance(values, dict) else {}
    return {
        name: HIDDEN
        if name in names
        else _masked(value, names)
        if isinstance(value, dict)
        else value
        for name, value in shown.items()
    }


def _unique(labels: Mapping[str, str]) -> dict[str, str]:
    """Labels that stand for several conditions get a number each."""
    found: dict[str, str] = {}
    for name, label in labels.items():
        count = 1
        unique = label or "?"
        while unique in found.values():
            count += 1
            unique = f"{label} ({count})"
        found[name] = unique
    return found


@cache
def _word_fields(kind: type[m.RestrictedMessage]) -> tuple[str, ...]:
    """The fields of its words."""
    texts = (field.name for field in fields(kind) if field.type is str)
    return tuple(name for name in texts if name not in NAMES)


def _texts(value: Json) -> Iterable[str]:
    """All texts in it, and of those that name a file its name: a robot gets it by another way."""
    match value:
        case str() if value:
            yield value
            yield PurePath(value).name or value
        case list():
            for one in value:
                yield from _texts(one)
        case dict():
            yield from _texts([*value.values()])


def _without(value: Any, given: Iterable[str]) -> Any:
    match value:
        case str() if any(_holds(value, text) for text in given):
            return HIDDEN
        case list():
            return [_without(one, given) for one in value]
        case dict():
            return {name: _without(one, given) for name, one in value.items()}
    return value


def _holds(value: str, text: str) -> bool:
    """Whether a value is made of a text; a short text stands in many by chance."""
    return text in value if len(text) >= _LONG else text == value


def _numbered(order: Sequence[str]) -> list[str]:
    return [str(number) for number, _ in enumerate(order, 1)]


def _for_participant(study: s.StudySettings) -> s.StudySettings:
    """What a participant's terminal needs of a study."""
    return replace(
        study,
        blind={},
        preflight=[],
        perception=s.PerceptionView(),
        shaping=None,
        by_condition={},
        assigned=_numbered(study.assigned),
    )


#: What is done with a kind of message for somebody who is blind to the condition.
_BLINDED: Mapping[type[m.Message], Callable[[Redactor, Any], m.Message | None]] = {
    m.SessionStart: Redactor._condition,
    m.SessionChanged: Redactor._condition,
    m.ParticipantWithdrawn: Redactor._condition,
    m.TrialStarted: Redactor._condition,
    m.ConditionsAssigned: Redactor._assigned,
    m.ExperimentFiles: Redactor._files,
    m.SessionPlan: Redactor.plan,
    m.ExperimentReloaded: Redactor._reloaded,
    m.BodyChanged: Redactor._shown_values,
    m.SettingsShown: Redactor._shown_values,
    m.FaceShown: Redactor._face_name,
    m.ModeChanged: Redactor._mode,
    m.PreflightChecked: Redactor._checked,
}
#: Messages that are not shown at all where this is hidden.
_SHOWN_WITH: Mapping[type[m.Message], str] = {
    m.EngagementShown: "engagement",
    m.EngagementChanged: "engagement",
    m.VisitorChanged: "identity",
    m.AddressedChanged: "presence",
    m.SpeechStarted: "loudness",
    m.SpeechText: "transcript",
    m.FaceShown: "face",
}
#: What is done with a kind of message for restricted perception.
_PERCEIVED: Mapping[type[m.Message], Callable[[Redactor, Any], m.Message | None]] = {
    m.Reading: Redactor._reading,
    m.SensorChanged: Redactor._sensor,
    m.EngagementShown: Redactor._model,
    m.EngagementChanged: Redactor._engaged,
    m.ModeChanged: Redactor._mode_why,
    m.SpeechEnded: Redactor._speech_ended,
    m.SpeechText: Redactor._speech_text,
    m.BodyChanged: Redactor._body,
    m.SettingsShown: Redactor._settings,
    m.PreflightChecked: Redactor._checked,
    m.SessionPlan: Redactor._plan_perceived,
    m.Command: Redactor._effect,
    m.ActionRequested: Redactor._effect,
    **dict.fromkeys(
        (m.ActionDone, m.ActionFailed, m.ActionStopped, m.ActionSuperseded, m.ActionRefused),
        Redactor._effect,
    ),
}
