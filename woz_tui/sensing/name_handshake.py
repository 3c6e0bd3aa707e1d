"""How the robot learns an unknown visitor's name: asks, repeats, has it confirmed, gives up.

Pure: time comes in as whole microseconds, what the robot shall do comes back as an order.

    handshake = Handshake(settings, visitors.is_taken)
    order = handshake.begin(t)              -> Say: the robot speaks it
    handshake.robot_finished(t)             its utterance has ended, in whatever way: silence counts
    handshake.speaks(t) / .spoke(t)         the visitor begins, stops: meanwhile nothing is asked
    order = handshake.visitor_said(text, t) what was understood ("" for nothing)
    order = handshake.advance(t)            time passes; at the latest at `due()`
    order = handshake.learnt(ok, t)         answer to Learn: face and name are stored, or not
    order = handshake.recognised(name, t)   the recogniser knows them meanwhile
    order = handshake.abandon(why, t)       wizard, machine or stop end it

Orders: `Say(text, why)`; `Learn(name, known, consent)`: store the name (`known`: it is a visitor
from before; give them the face, leave the profile alone) and answer with `learnt`; `consent`:
whether the visitor has said that their face may be learnt, None: nobody asked; `NameLearned(name,
known, say)` and `HandshakeFailed(say, why)` end it, `say` is the robot's last sentence (may be
empty). Where there is nothing to do, the answer is None. After the end every call returns None.

Bounds: a name is asked for or taken up at most `attempts` times, whoever causes it: silence, an
answer that holds no name, a denial, another name. The whole takes at most `seconds` from `begin`.
Nothing is learnt that was not confirmed, and a name that is taken is never given a second time.
The question for the face comes last and is repeated once; whatever is no clear yes is a no, and the
name counts all the same.
"""

from __future__ import annotations

import enum
from collections.abc import Callable
from dataclasses import dataclass

from woz_tui.config.engagement import HandshakeSettings
from woz_tui.config.utterance_template import fill
from woz_tui.config.visitor_names import VisitorNameError, name_of, quoted_name
from woz_tui.sensing.answer_parsing import NameAnswer, NameAnswerParser

_SECOND = 1_000_000
#: The machine ends a handshake by the same time. The question for the face is over before, so that
#: the confirmed name is there first.
_BEFORE_END = _SECOND // 2
#: So many words in a row of the robot's own are an echo.
_ECHO = 3
#: The only variable that the sentences know.
_NAME = "name"


@dataclass(frozen=True, slots=True)
class Say:
    """The robot shall say this; `robot_finished` when it is over."""

    text: str
    why: str


@dataclass(frozen=True, slots=True)
class Learn:
    """Store the visitor, and their face where it can be; then `learnt`."""

    name: str
    known: bool
    consent: bool | None = None


@dataclass(frozen=True, slots=True)
class NameLearned:
    """They are known. `known`: from before this handshake."""

    name: str
    known: bool
    say: str
    why: str


@dataclass(frozen=True, slots=True)
class HandshakeFailed:
    """They stay unknown."""

    say: str
    why: str


Order = Say | Learn | NameLearned | HandshakeFailed


class HandshakeStage(enum.StrEnum):
    """What the handshake waits for."""

    NEW = "new"
    NAME = "a name"
    CONFIRMATION = "a confirmation"
    ACQUAINTANCE = "whether it is the visitor of this name"
    CONSENT = "whether the face may be learnt"
    LEARNING = "the name to be stored"
    OVER = "over"


class Handshake:
    """One handshake with one visitor. `is_taken` tells whether a name belongs to somebody;
    `learns_faces`: somebody can learn the face, so that it is worth asking.
    """

    def __init__(
        self,
        settings: HandshakeSettings,
        is_taken: Callable[[str], bool],
        *,
        learns_faces: bool = True,
    ) -> None:
        self.stage = HandshakeStage.NEW
        #: How many names were asked for or taken up so far.
        self.attempt = 0
        #: The name in question; empty: none yet.
        self.name = ""
        self._settings = settings
        self._is_taken = is_taken
        self._answers = NameAnswerParser(settings.yes, settings.no)
        self._known = False
        self._asks_for_face = learns_faces and bool(settings.face_consent.strip())
        #: Whether the question for the face was repeated.
        self._repeated = False
        self._now = 0
        self._ends = 0
        self._quiet_since = 0
        self._talks = False
        self._speaks = False
        self._question = ""
        self._sentence = ""

    # -- what happens ---------------------------------------------------------------------------

    def begin(self, t: int) -> Say:
        """Ask for the name. Raises `ValueError` if it has begun already."""
        if self.stage is not HandshakeStage.NEW:
            raise ValueError("this handshake has begun already")
        self._now = t
        self._ends = t + round(self._settings.seconds * _SECOND)
        self.stage = HandshakeStage.NAME
        self.attempt = 1
        return self._say(self._settings.ask, "asks for the name")

    def robot_finished(self, t: int) -> None:
        """The robot's sentence is over, or could not be spoken."""
        self._pass(t)
        self._talks = False
        self._quiet_since = self._now

    def speaks(self, t: int) -> None:
        """The visitor speaks: nothing is asked until `spoke` or `visitor_said`."""
        self._pass(t)
        self._speaks = True

    def spoke(self, t: int) -> None:
        """The visitor has stopped; what was said may still come."""
        self._pass(t)
        self._speaks = False
        self._quiet_since = self._now

    def visitor_said(self, text: str, t: int) -> Order | None:
        """What the visitor said, as it was understood; empty: it was not.

        While the robot speaks it is taken for the robot's own voice, and so is what repeats the
        robot's last sentence.
        """
        self._pass(t)
        self._speaks = False
        if not self._asks or self._talks or self._now >= self._ends or self._echo(text):
            return self.advance(t)
        if self.stage is HandshakeStage.CONSENT:
            answer = self._answers.read_consent(text)
            if answer.yes or answer.no or answer.declined:
                return self._learn(consent=answer.yes)
            return self._ask_for_face_again(answer.why or "neither yes nor no was understood")
        answer = self._answers.read(text, self.name)
        if answer.declined:
            return self._fail("the visitor does not want to tell")
        if self.stage is HandshakeStage.NAME:
            if not answer.name:
                return self._again(answer.why or "no name was understood")
            return self._take_up(answer)
        return self._answered(answer)

    def advance(self, t: int) -> Order | None:
        """Time passes: a silence may be over, or all the time there is."""
        self._pass(t)
        if self.stage in (HandshakeStage.NEW, HandshakeStage.OVER):
            return None
        asks_for_face = self.stage is HandshakeStage.CONSENT
        if self._now >= self._ends:
            if asks_for_face:
                return self._learn(consent=False)
            return self._fail(f"no name after {self._settings.seconds:g} s")
        quiet = self._quiet_until
        if quiet is not None and self._now >= quiet:
            why = f"no answer for {self._settings.silence:g} s"
            return self._ask_for_face_again(why) if asks_for_face else self._again(why)
        return None

    def due(self) -> int | None:
        """When `advance` has something to do, if nothing happens before."""
        if self.stage in (HandshakeStage.NEW, HandshakeStage.OVER):
            return None
        quiet = self._quiet_until
        return self._ends if quiet is None else min(quiet, self._ends)

    def learnt(self, ok: bool, t: int, why: str = "") -> Order | None:
        """The answer to `Learn`; `why` it was not possible."""
        self._pass(t)
        if self.stage is not HandshakeStage.LEARNING:
            return None
        if not ok:
            return self._fail(why or f"{quoted_name(self.name)} could not be learnt")
        return self._done("a visitor from before" if self._known else "name confirmed and learnt")

    def recognised(self, name: str, t: int) -> NameLearned | None:
        """Somebody, a camera or the wizard, knows who it is."""
        self._pass(t)
        if self.stage in (HandshakeStage.NEW, HandshakeStage.OVER):
            return None
        self.name, self._known = name, True
        return self._done("recognised meanwhile")

    def abandon(self, why: str, t: int) -> HandshakeFailed | None:
        """End it without a word of farewell."""
        self._pass(t)
        if self.stage is HandshakeStage.OVER:
            return None
        self._end()
        return HandshakeFailed("", why)

    def worded(self, sentence: str) -> str:
        """A sentence of the settings as the robot says it: `{name}` is the name in question."""
        return fill(sentence, lambda variable: self.name if variable == _NAME else "")

    # -- answers --------------------------------------------------------------------------------

    def _answered(self, answer: NameAnswer) -> Order:
        """An answer to `is that right?` or `is that you?`."""
        if answer.yes:
            return self._confirmed()
        if answer.name:
            return self._next_attempt() or self._take_up(answer)
        if not answer.no:
            return self._again(answer.why or "neither yes nor no was understood")
        return self._next_attempt() or self._ask_for_another()

    def _confirmed(self) -> Order:
        known = self._is_taken(self.name)
        if known and self.stage is not HandshakeStage.ACQUAINTANCE:
            return (
                self._next_attempt(f"{quoted_name(self.name)} was taken meanwhile")
                or self._ask_back()
            )
        self._known = known
        if not self._asks_for_face:
            return self._learn(consent=None)
        self.stage = HandshakeStage.CONSENT
        self._ends -= _BEFORE_END
        return self._say(self._settings.face_consent, "asks whether the face may be learnt")

    def _ask_for_face_again(self, why: str) -> Order:
        """Once; then it is a no."""
        if self._repeated:
            return self._learn(consent=False)
        self._repeated = True
        return self._say(self._settings.face_consent, why)

    def _learn(self, *, consent: bool | None) -> Learn:
        self.stage = HandshakeStage.LEARNING
        return Learn(self.name, self._known, consent)

    def _take_up(self, answer: NameAnswer) -> Order:
        try:
            self.name = name_of(answer.name)
        except VisitorNameError as error:
            self.stage, self.name = HandshakeStage.NAME, ""
            return self._again(error.reason)
        return self._ask_back()

    def _ask_back(self) -> Say:
        """Ask whether the name is right, or whether it is the visitor who has it already."""
        if self._is_taken(self.name):
            self.stage = HandshakeStage.ACQUAINTANCE
            return self._say(self._settings.taken, f"{quoted_name(self.name)} is known already")
        self.stage = HandshakeStage.CONFIRMATION
        return self._say(self._settings.confirm, f"understood {quoted_name(self.name)}")

    def _ask_for_another(self) -> Say:
        taken = self.stage is HandshakeStage.ACQUAINTANCE
        why = f"{quoted_name(self.name)} was denied"
        self.stage, self.name = HandshakeStage.NAME, ""
        return self._say(self._settings.another if taken else self._settings.again, why)

    def _again(self, why: str) -> Order:
        """Ask once more what was asked; it counts."""
        failed = self._next_attempt(why)
        if failed is not None:
            return failed
        if self.stage is HandshakeStage.NAME:
            return self._say(self._settings.again, why)
        return self._say(self._question, why)

    # -- bounds ---------------------------------------------------------------------------------

    @property
    def _asks(self) -> bool:
        return self.stage in (
            HandshakeStage.NAME,
            HandshakeStage.CONFIRMATION,
            HandshakeStage.ACQUAINTANCE,
            HandshakeStage.CONSENT,
        )

    @property
    def _quiet_until(self) -> int | None:
        """When silence has lasted long enough; None while somebody speaks."""
        if self._talks or self._speaks or not self._asks:
            return None
        return self._quiet_since + round(self._settings.silence * _SECOND)

    def _echo(self, text: str) -> bool:
        """Whether `text` is a good part of what the robot has just said."""
        words = text.casefold().split()
        return len(words) >= _ECHO and " ".join(words) in " ".join(self._sentence.split())

    def _pass(self, t: int) -> None:
        self._now = max(self._now, t)

    def _say(self, template: str, why: str) -> Say:
        self._talks = True
        self._question = template
        text = self.worded(template)
        self._sentence = text.casefold()
        return Say(text, why)

    def _next_attempt(self, why: str = "the name was denied") -> HandshakeFailed | None:
        if self.attempt >= self._settings.attempts:
            plural = "s" if self.attempt > 1 else ""
            return self._fail(f"{why}; no name in {self.attempt} attempt{plural}")
        self.attempt += 1
        return None

    def _done(self, why: str) -> NameLearned:
        self._end()
        return NameLearned(self.name, self._known, self.worded(self._settings.welcome), why)

    def _fail(self, why: str) -> HandshakeFailed:
        self._end()
        return HandshakeFailed(self.worded(self._settings.give_up), why)

    def _end(self) -> None:
        self.stage = HandshakeStage.OVER
