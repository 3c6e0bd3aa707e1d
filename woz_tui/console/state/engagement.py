"""The engagement model for the screen: its state, its past changes, what visitors said."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from woz_tui.protocol import messages as m
from woz_tui.sensing.sample_values import agreed
from woz_tui.timeline.episodes import UtteranceEpisode
from woz_tui.timeline.session_state import SessionState

#: Changes and understood utterances that are kept; the log has them all.
CHANGES, HEARD = 60, 40
#: An utterance that is open for longer has lost its end, in microseconds.
ENDLESS_US = 600_000_000
#: Runs of the machine that are not the usual one, as a reader of messages must expect them.
HOLD, OFF = "hold", "off"


@dataclass(slots=True)
class EngagementView:
    """What holds is in `session`; `apply` remembers what was: the model's changes, what visitors
    said, what is known of them by code.
    """

    session: SessionState = field(default_factory=SessionState)
    changes: deque[m.EngagementChanged] = field(default_factory=lambda: deque(maxlen=CHANGES))
    visitors: dict[str, dict[str, str]] = field(default_factory=dict)
    _transcripts: deque[m.SpeechText] = field(default_factory=lambda: deque(maxlen=HEARD))
    #: By driver: the last text so far, and its beginning that the one before had already.
    _so_far: dict[str, tuple[str, str]] = field(default_factory=dict)

    @property
    def held(self) -> bool:
        """Whether the machine moves by hand only."""
        shown = self.session.model.shown
        return shown is not None and shown.run == HOLD

    @property
    def off(self) -> bool:
        """Whether the machine does nothing at all."""
        shown = self.session.model.shown
        return shown is not None and shown.run == OFF

    def waited(self, now: int) -> int | None:
        """For how long the visitor has been waiting for an answer (us); None: nobody waits, or
        nobody tells, as the model is off.
        """
        shown = self.session.model.shown
        if shown is None or self.off or shown.waits_since < 0:
            return None
        return max(0, now - shown.waits_since)

    def speaking(self, now: int) -> UtteranceEpisode | None:
        """The visitor's utterance that goes on now, if one does."""
        for spoken in reversed(self.session.speaking.values()):
            if not spoken.own:
                return spoken if now - spoken.begin < ENDLESS_US else None
        return None

    def firm(self, driver: str) -> str:
        """The beginning of the last text so far that will hardly be taken back."""
        return self._so_far.get(driver, ("", ""))[1]

    def transcripts(self) -> list[m.SpeechText]:
        """What visitors were understood to say, newest first."""
        return [text for text in reversed(self._transcripts) if text.text and not text.own]

    def moves(self, now: int) -> bool:
        """Whether a figure on the screen grows by itself: somebody waits or speaks."""
        return self.waited(now) is not None or self.speaking(now) is not None

    def apply(self, message: m.Message) -> None:
        """Work a message in; others than those of the model are passed over."""
        match message:
            case m.EngagementChanged():
                self.changes.append(message)
            case m.Reading(sensor=sensor, driver=driver, text=text) if text:
                if sensor.rpartition(".")[2] == m.SPEECH_SENSOR:
                    earlier, _ = self._so_far.get(driver, ("", ""))
                    self._so_far[driver] = (text, agreed(earlier, text))
            case m.SpeechStarted(driver=driver):
                self._so_far.pop(driver, None)
            case m.SpeechText(driver=driver, segment=segment):
                for before in [*self._transcripts]:  # it was understood once more
                    if (before.driver, before.segment) == (driver, segment):
                        self._transcripts.remove(before)
                self._transcripts.append(message)
            case m.VisitorChanged():
                about = self.visitors.pop(message.was or message.visitor, {})
                if message.what != "forgotten":
                    self.visitors[message.visitor] = {**about, **texts(message.about)}

    def forget(self) -> None:
        """Forget what was: there is no model any more, or it is kept from the wizard."""
        self.changes.clear()
        self._transcripts.clear()
        self._so_far.clear()
        self.visitors.clear()


def texts(told: object) -> dict[str, str]:
    """Those values of `told` that are texts; another version may send anything."""
    pairs = told.items() if isinstance(told, dict) else ()
    return {str(name): value for name, value in pairs if isinstance(value, str)}
