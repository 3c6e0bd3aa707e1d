"""Writes into the log what `woz lsl` tells, and uses what comes over streams as the file says."""

from __future__ import annotations

from woz_tui.config.experiment import Experiment
from woz_tui.drivers.contract import Finding
from woz_tui.features.lsl.history import LslHistory
from woz_tui.features.lsl.kinds import (
    AskLslBegin,
    AskLslTake,
    AskLslTell,
    LslAdopted,
    LslLost,
    TakenStream,
)
from woz_tui.features.lsl.section import LSL, TakenEntry
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.session_features import Client, FeatureSession, SessionFeature

#: The source of markers that came over a stream and want no answer.
SOURCE = "lsl"
#: Characters of a text that came over a stream.
MOST_TEXT = 200


class LslInSession(SessionFeature):
    """What one session has of the streams; the streams themselves are in another process."""

    requests = (AskLslBegin, AskLslTell, AskLslTake)

    def __init__(self, session: FeatureSession) -> None:
        super().__init__(session)
        #: The connection of the program that sends the session; empty: none does.
        self._console = ""
        self._said = adopted(session.experiment)

    def begin(self) -> None:
        if LSL.of(self.session.experiment) is not None:
            self.session.hub.publish(self._said)

    def adopt(self, experiment: Experiment) -> None:
        if (now := adopted(experiment)) != self._said:
            self._said = now
            self.session.hub.publish(now)

    def carry_out(self, request: AskLslBegin | AskLslTell | AskLslTake, client: Client) -> str:
        if client.role != "program":
            raise RequestError(
                Sentence("lsl.only_programs", "only a program sends a session as streams")
            )
        if isinstance(request, AskLslBegin):
            if self._console not in ("", client.console):
                raise RequestError(
                    Sentence("lsl.sent_already", "another `woz lsl` sends this session already"),
                    Sentence("lsl.end_first", "end that one first"),
                )
            self._console = client.console
        elif self._console != client.console:
            raise RequestError(Sentence("lsl.begin_first", "begin with lsl.begin"))
        elif isinstance(request, AskLslTell):
            self.session.hub.publish(request.told)
        else:
            self._take(request)
        return ""

    def _take(self, request: AskLslTake) -> None:
        entry = self._taken(request.stream)
        if entry is None:
            raise RequestError(
                Sentence(
                    "lsl.not_taken",
                    "the file takes no stream {stream!r}",
                    stream=request.stream,
                ),
                Sentence("lsl.name_it", "name it: lsl: {{take: [...]}}"),
            )
        hub = self.session.hub
        if entry.as_ == "reading":
            if request.value is None:
                raise RequestError(Sentence("lsl.no_number", "a reading is a number"))
            hub.publish(m.Reading(sensor=entry.called, value=request.value, driver=SOURCE))
            return
        marker = m.Marker(
            text=request.text[:MOST_TEXT],
            at=min(max(request.at, 0), hub.now()),
            source="program" if entry.as_ == "cue" else SOURCE,
            # What another program calls its stimuli may say which condition this is.
            tells=("condition",) if self.session.state.study.settings.blind else (),
        )
        hub.publish(marker)

    def _taken(self, stream: str) -> TakenEntry | None:
        settings = LSL.of(self.session.experiment)
        takes = settings.take if settings is not None else ()
        return next((each for each in takes if each.stream == stream), None)

    def lose(self, console: str) -> None:
        """Without its program no stream is there."""
        if not console or console != self._console:
            return
        self._console = ""
        history = self.session.state.history(LslHistory)
        there = [(name, True) for name in history.sent] + [(name, False) for name in history.found]
        for stream, sent in there:
            self.session.hub.publish(
                LslLost(
                    stream=stream,
                    why=Sentence("lsl.ended", "woz lsl has ended"),
                    outgoing=sent,
                )
            )

    def companion(self) -> str:
        settings = LSL.of(self.session.experiment)
        return "lsl" if settings is not None and settings.start else ""

    def findings(self) -> list[Finding]:
        """Whether somebody records, and which streams are there."""
        if not self._console:
            if LSL.of(self.session.experiment) is None:
                return []
            start = f"woz lsl {self.session.identity.session}"
            return [
                Finding(
                    "warning",
                    "lsl",
                    Sentence("lsl.not_running", "`woz lsl` does not run: nothing is sent"),
                    start,
                )
            ]
        history = self.session.state.history(LslHistory)
        findings = [
            Finding("ok", stream.stream, Sentence("lsl.recorded", "a recorder takes it"))
            if stream.taken
            else Finding(
                "warning",
                stream.stream,
                Sentence("lsl.not_recorded", "nobody records it"),
                Sentence("lsl.begin_recording", "begin the lab's recording"),
            )
            for stream in history.sent.values()
        ]
        for taken in self._said.takes:
            found = history.found.get(taken.stream)
            if found is not None:
                where = found.host or "this network"
                findings.append(
                    Finding(
                        "ok",
                        taken.stream,
                        Sentence("lsl.comes_from", "it comes from {where}", where=where),
                    )
                )
            else:
                remedy = Sentence(
                    "lsl.start_source",
                    "start the program that sends it, or look at its name",
                )
                findings.append(
                    Finding(
                        "warning",
                        taken.stream,
                        Sentence("lsl.no_stream", "there is no such stream"),
                        remedy,
                    )
                )
        return findings


def adopted(experiment: Experiment) -> LslAdopted:
    """What `woz lsl` goes by with this file."""
    settings = LSL.of(experiment)
    if settings is None:
        return LslAdopted()
    return LslAdopted(
        prefix=settings.prefix,
        sensors=[*settings.sensors],
        shares=[*settings.shares],
        takes=[
            TakenStream(
                stream=each.stream,
                source_id=each.source_id,
                type=each.type,
                use=each.as_,
                sensor=each.called if each.as_ == "reading" else "",
                every_us=round(each.every * 1e6) if each.as_ == "reading" else 0,
            )
            for each in settings.take
        ],
    )
