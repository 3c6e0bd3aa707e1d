"""Carries out the requests of consoles and programs, and answers them."""

from __future__ import annotations

import asyncio
import dataclasses
import functools
import logging
from collections.abc import Callable, Mapping
from functools import partial
from typing import Protocol, cast

import msgspec
from msgspec.structs import replace

from woz_tui.config.experiment import Call, Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.problems import with_remedy
from woz_tui.config.reload_changes import compare
from woz_tui.drivers.contract import Finding, HandInput
from woz_tui.gate.facts import Facts
from woz_tui.gate.questions import ClientRequest, RequestOrigin
from woz_tui.gate.table import not_done, why_not
from woz_tui.host.client_connection import ClientConnection, part_text, take_over_hint
from woz_tui.host.dead_man_switch import DeadManSwitch
from woz_tui.host.picture_service import PictureService
from woz_tui.host.sound_service import SoundService
from woz_tui.protocol.action_messages import HAND_DEVICES
from woz_tui.protocol.messages import (
    ActionDone,
    ActionEnd,
    ActionRefused,
    Done,
    End,
    Json,
    Message,
    Notice,
    Refused,
)
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.requesters import requester
from woz_tui.protocol.requests import (
    AgedRequest,
    AskAction,
    AskCancel,
    AskCheck,
    AskControls,
    AskDescribe,
    AskEmptyQueue,
    AskEnd,
    AskKeepTyped,
    AskLetGo,
    AskLock,
    AskMarker,
    AskMistake,
    AskNote,
    AskPicture,
    AskPredict,
    AskPreflight,
    AskRelease,
    AskReload,
    AskSet,
    AskSound,
    AskTalk,
    AskUnrecorded,
    AskVerb,
    Reply,
    Request,
)
from woz_tui.protocol.sentence import Sentence, wording_of
from woz_tui.session.action_texts import given_values
from woz_tui.session.session import Session
from woz_tui.session.session_features import Client
from woz_tui.session.typed_actions import Reader, copy_with_sentences, without_typed, write_beside
from woz_tui.session.variables import MissingValueError, filled_call
from woz_tui.system.tasks import TaskSet

log = logging.getLogger(__name__)

#: Sources of what the robot process, its drivers and its re-runs do by themselves: no console's.
NOT_OF_CLIENTS = frozenset(
    {"engagement", "replay", "phase", "midi", *HAND_DEVICES, "driver", "body"}
)
#: What takes its time, because it reads files or asks devices.
Slow = AskReload | AskKeepTyped | AskPredict | AskPreflight
#: What a wizard reads instead of a change of the file that tells the condition.
_HIDDEN_CHANGE = Sentence("reload.hidden", "a change that could reveal the condition")
#: So many of one kind may wait for each client, while the one before is worked on.
SLOW_WAITING = 16


class RequestServer(Protocol):
    """What requests have the server of a session do."""

    def end(self, reason: str) -> None:
        """End the session."""

    def can_take_over(self, client: ClientConnection) -> bool:
        """Whether a console that watches could play: there is a part that nobody plays."""

    def restrict(self, experiment: Experiment) -> None:
        """A file is about to be adopted: who is to be blind by it is so before anything is said."""


class RequestHandlers:
    """Answers requests for one session.

    Args:
        session: What is asked of.
        load: Reads the experiment file again; raises `ExperimentError`.
        read: Reads a text as if that file held it; raises `ExperimentError`.
    """

    def __init__(
        self, session: Session, load: Callable[[], Experiment], read: Reader | None = None
    ) -> None:
        self._session = session
        self._load = load
        self._read = read or (lambda data: load())
        self._pictures = PictureService(session)
        self._sound = SoundService(session)
        self._tasks = TaskSet("slow requests")
        self._slow: dict[tuple[ClientConnection, type[Request]], list[Request]] = {}
        self._reading = asyncio.Lock()  # what was read last is what counts
        self._looking = asyncio.Lock()  # features into files, one after the other
        #: The server that has these handlers, and which knows what keys drive only while held.
        self.server: RequestServer
        self.switch: DeadManSwitch
        #: What has ended while a request is carried out, by run or command; None: none is.
        self._ends: dict[str, ActionEnd | End] | None = None
        session.hub.listen(self._note_end, ActionEnd, End)

    def answer(self, client: ClientConnection, request: Request) -> None:
        """Carry `request` out and reply; every request gets exactly one reply; a picture is one."""
        if client.view is not None:
            request = client.view.redactor.request(request)
        question = self._question(client, request)
        refusal = why_not(Facts(ended=self._session.ended), question)
        if refusal is not None:
            with self._session.hub.on_behalf_of(client.name):
                self._session.log_too_old(refusal)
            client.refuse(request.ref, refusal.reason, refusal.remedy, refusal.command)
        elif self._deferred(client, request):
            pass  # it is answered once somebody has decided
        elif isinstance(request, AskDescribe):
            client.send(Reply(ref=request.ref, ok=True, data=self._session.describe()))
        elif isinstance(request, AskPicture):
            self._pictures.answer(client, request)
        elif isinstance(request, AskSound | AskTalk):
            self._answer_sound(client, request)
        elif isinstance(request, (Slow, *self._session.features.lookups)):
            self._answer_in_background(client, request)
        else:
            client.send(self._answer_at_once(client, request))

    def _deferred(self, client: ClientConnection, request: Request) -> bool:
        """Whether a feature has it wait, or has refused it."""
        if not self._session.features.deferring:
            return False
        asks = Client(client.name, client.role, self._by(client), self._tells(client))
        try:
            with self._session.hub.on_behalf_of(client.name):
                return self._session.features.defer(
                    request, asks, partial(self._decided, client, request)
                )
        except RequestError as error:
            client.send(_refused(client, request, error))
            return True

    def _decided(
        self, client: ClientConnection, request: Request, decided: Request | RequestError
    ) -> Reply:
        """Carry out what waited, or refuse it, and answer its client."""
        if isinstance(decided, RequestError):
            reply = _refused(client, request, decided)
        else:
            reply = self._answer_at_once(client, decided)
        client.send(reply)
        return reply

    def _answer_sound(self, client: ClientConnection, request: AskSound | AskTalk) -> None:
        try:
            if isinstance(request, AskSound):
                self._sound.answer_listener(client, request)
            else:
                client.send(self._sound.answer_talker(client, request))
        except RequestError as error:
            client.send(_refused(client, request, error))

    def _question(self, client: ClientConnection, request: Request) -> ClientRequest:
        stale = self._stale(request) if not_done(request) else ""
        if client.role != "watcher":
            return ClientRequest(request, client.role, stale)
        return ClientRequest(
            request,
            client.role,
            stale,
            plays=part_text(client),
            vacant=self.server.can_take_over(client),
            take_over=take_over_hint(client),
        )

    def _answer_at_once(self, client: ClientConnection, request: Request) -> Reply:
        ends: dict[str, ActionEnd | End] = {}
        around, self._ends = self._ends, ends  # of the request that lets this one happen
        try:
            with self._session.hub.on_behalf_of(client.name):
                run = self._carry_out(client, _with_own_source(client, request))
        except RequestError as error:
            reply = _refused(client, request, error)
            if request.plays:
                runs = [
                    run for run, end in ends.items() if isinstance(end, ActionRefused | Refused)
                ]
                reply = replace(reply, run=runs[-1] if runs else "")
            return reply
        finally:
            self._ends = around
        reply, end = Reply(ref=request.ref, ok=True, run=run), ends.get(run)
        return reply if end is None else _with_end(client, reply, end)

    def _note_end(self, message: Message) -> None:
        if self._ends is None:
            return
        match message:
            case ActionEnd(run=run):
                self._ends[run] = message
            case End(command=command):
                self._ends[command] = message

    def _carry_out(self, client: ClientConnection, request: Request) -> str:
        """Carry `request` out; the id of the run or command that it has begun."""
        session = self._session
        run, stale, tells = "", self._stale(request), self._tells(client)
        match request:
            case AskAction(action=action, source=source, key=key, when_busy=when_busy):
                origin = RequestOrigin(source, key, client.name)
                given = given_values(request, tells, by_program=client.role != "wizard")
                play = partial(
                    session.play, action, origin, when_busy, stale, request.at, given=given
                )
                run = play() if stale else self.switch.play(client, request, play)
            case AskVerb():
                send = partial(self._send_verb, client, request, stale)
                run = send() if stale else self.switch.play(client, request, send)
            case AskLetGo(key=key):
                self.switch.let_go(client, key)
            case AskRelease(source=source, missing=missing):
                session.release(source, stale, missing)
            case AskControls():
                self._take_hand(client, request)
            case AskCancel(run="", asked=ref):
                session.features.withdraw(client.name, ref)
            case AskCancel(run=ended):
                session.cancel(ended, self._by(client))
            case AskEmptyQueue():
                session.empty_queue(self._by(client))
            case AskSet(participant=participant, condition=condition, trial=trial):
                session.set(participant, condition, trial)
            case AskMarker(text=text, at=at):
                session.mark(text, client.role, tells, at)
            case AskNote(text=text):
                session.note(text, tells)
            case AskMistake(run=wrong, text=text):
                session.mistake(wrong, text, tells, client.name)
            case AskLock(panel=panel, locked=locked):
                session.lock(panel, locked)
            case AskUnrecorded():
                session.go_on_unrecorded()
            case AskEnd(reason=reason):
                session.end_tells = tells
                self.server.end(reason)
            case AskCheck(check=check, ok=ok, text=text):
                session.tick(check, ok, text, client.role)
            case _:
                asks = Client(client.name, client.role, self._by(client), tells, stale)
                run = session.features.carry_out(request, asks)
        return run

    def _by(self, client: ClientConnection) -> str:
        """Who it is, in words."""
        return requester(client.role, self._session.state.consoles.get(client.name))

    def _tells(self, client: ClientConnection) -> tuple[str, ...]:
        """What words of this client may tell: one that sees all may write of the condition."""
        blinds = bool(self._session.state.study.settings.blind)
        return ("condition",) if blinds and client.view is None else ()

    def _send_verb(self, client: ClientConnection, request: AskVerb, stale: str) -> str:
        """Send it with its variables filled in, as in the experiment file."""
        args, call = self._hidden(request)
        texts = call.args
        if not stale:
            call = self._filled(call)
        if tells := self._tells(client):
            call = dataclasses.replace(call, tells=tells, unfilled=dict.fromkeys(texts, "..."))
        run = self._session.send(
            request.verb,
            {**args, **call.args},
            request.on,
            RequestOrigin(request.source, request.key, client.name),
            when_busy=request.when_busy,
            stale=stale,
            tells=call.tells,
            unfilled=call.unfilled,
            at=request.at,
        )
        typed = request.verb == "say" and request.source == "key" and client.role == "wizard"
        if (
            typed
            and [*args] == ["text"]
            and self._session.add_typed_button(str(texts["text"]), request.on)
        ):
            self._session.on_panels()
        return run

    def _hidden(self, request: AskVerb | AskPredict) -> tuple[Mapping[str, Json], Call]:
        """The arguments as they may be recorded, and a call with those that are texts: before
        variables are filled in, since a sentence about one would quote what stands in braces.
        """
        args = self._session.bus.hidden(request.verb, request.args)
        texts = {name: text for name, text in args.items() if isinstance(text, str)}
        return args, Call(request.verb, texts, request.on)

    def _filled(self, call: Call) -> Call:
        try:
            return filled_call(call, self._session.values())
        except MissingValueError as error:
            raise RequestError(
                error.reason,
                Sentence("host.braces", "to write a brace, double it: {{{{ or }}}}"),
            ) from error

    async def _predict(self, client: ClientConnection, request: AskPredict) -> Json:
        """Of what is kept from the client neither words nor times."""
        view = client.view

        def kept(call: Call) -> bool:
            return view is not None and view.redactor.keeps(call.tells)

        if request.action and not request.verb:
            prediction = await self._session.predict_action(request.action, kept)
        elif request.verb and not request.action:
            args, call = self._hidden(request)
            call = self._filled(call)
            whole = dataclasses.replace(call, args={**args, **call.args})
            prediction = await self._session.predict_verb(whole, kept)
        else:
            raise RequestError(
                Sentence("host.predict_what", "predict needs either an action or a verb")
            )
        plain: Json = msgspec.to_builtins(prediction)
        return plain

    def _take_hand(self, client: ClientConnection, request: AskControls) -> None:
        session = self._session
        age_us = session.standstill.waited_us(request.sent_us)
        if request.pulse:  # a pulse that went there, and what came back: no older than both ways
            age_us = max(age_us, session.hub.now() - request.pulse - request.since_us)
        hand = HandInput(
            client=client.name,
            values=request.values,
            device=request.device,
            take_over=request.take_over,
            age_us=age_us,
            stale=bool(session.too_old(age_us)),
        )
        session.take_hand(request.panel, hand)

    def _stale(self, request: Request) -> str:
        """Why it is too old to move anything; its time in the socket counts."""
        age_us = self._session.standstill.waited_us(request.sent_us)
        if request.aged:
            press = cast("AgedRequest", request)
            age_us += max(0, press.age_us)
            if press.stale:
                # Who stood still, computer, terminal or the line between them, nobody can tell.
                if self._session.too_old(age_us):
                    return Sentence(
                        "host.too_late",
                        "too late: it may have been pressed {seconds:.1f} s ago",
                        seconds=age_us / 1_000_000,
                    )
                return Sentence(
                    "host.too_many_keys",
                    "too late: it came with more keys at once than anybody types",
                )
        return self._session.too_old(age_us)

    # -- what takes its time -----------------------------------------------------------------

    def _answer_in_background(self, client: ClientConnection, request: Request) -> None:
        """One of a kind at a time for each client; what waits for one that left is dropped."""
        waiting = self._slow.get((client, type(request)))
        if waiting is None:
            waiting = self._slow[client, type(request)] = []
            self._tasks.start(self._work_off(client, type(request)))
        if len(waiting) < SLOW_WAITING:
            waiting.append(request)
        else:
            reason = Sentence(
                "host.many_requests",
                "too many requests of this kind are waiting ({slow_waiting})",
                slow_waiting=SLOW_WAITING,
            )
            client.refuse(
                request.ref,
                reason,
                Sentence("host.wait_answers", "wait for their answers"),
            )

    async def _work_off(self, client: ClientConnection, kind: type[Request]) -> None:
        waiting = self._slow[client, kind]
        while waiting and not client.closed.done():
            request = waiting[0]
            # Whoever asks the same from here on gets an answer of its own: things may have changed.
            same = [each for each in waiting if replace(each, ref=request.ref) == request]
            waiting[:] = [each for each in waiting if each not in same]
            reply = await self._slow_reply(client, request)
            for each in same:
                client.send(replace(reply, ref=each.ref))
        del self._slow[client, kind]

    async def _slow_reply(self, client: ClientConnection, request: Request) -> Reply:
        #: Lines that may tell the condition, and what stands for them where it is kept.
        instead: dict[str, str] = {}
        try:
            match request:
                case AskPredict():
                    data = await self._predict(client, request)
                    return Reply(ref=request.ref, ok=True, data=data)
                case AskPreflight():
                    from woz_tui.session.preflight import preflight  # noqa: PLC0415 - asks the machine

                    data = [*map(_finding_data, await preflight(self._session))]
                case AskKeepTyped():
                    async with self._reading:
                        data = await self._keep_typed(request.dry_run)
                case AskReload():
                    async with self._reading:
                        data = await self._reload(request.dry_run, instead)
                case _:
                    async with self._looking:
                        look_up = self._session.features.look_up
                        data = await asyncio.to_thread(look_up, request)
        except RequestError as error:
            return _refused(client, request, error)
        except ExperimentError as error:
            reply = Reply(
                ref=request.ref,
                ok=False,
                reason=Sentence(
                    "host.file_wrong",
                    "the file has {count} errors; nothing was changed",
                    one="the file has 1 error; nothing was changed",
                    count=len(error.problems),
                ),
                hint=Sentence(
                    "host.woz_check",
                    "`woz check {name}` tells what is wrong",
                    name=self._session.experiment.path.name,
                ),
                data=[problem.sentence for problem in error.problems],
            )
            places = {str(problem): str(problem.place) for problem in error.problems}
            return _redacted(client, reply, places)
        except Exception as error:
            # Whoever asked waits for an answer, also when a driver's package is broken.
            log.exception("%s failed", type(request).__name__)
            return Reply(ref=request.ref, ok=False, reason=f"{type(error).__name__}: {error}")
        return _redacted(client, Reply(ref=request.ref, ok=True, data=data), instead)

    async def _keep_typed(self, dry_run: bool) -> Json:
        """Also while the session ends: the sentences are there until the process has gone."""
        session = self._session
        typed, path = session.typed, session.experiment.path
        kept, file = session.saved_sentences
        data: dict[str, Json] = {"sentences": 0, "file": file, "diff": [], "written": False}
        if typed == kept:
            return data
        copy = await asyncio.to_thread(copy_with_sentences, path, typed, self._read)
        if copy.sentences and not dry_run:
            copy = await asyncio.to_thread(write_beside, path, copy)
            session.saved_sentences = typed, str(copy.file)
            data["written"] = True
            text = Sentence(
                "host.typed_kept",
                "Typed sentences are in {file}, a copy of the experiment file",
                file=copy.file.name,
            )
            if not session.ended:
                session.hub.publish(Notice(level="info", text=text))
        return {**data, "sentences": copy.sentences, "file": str(copy.file), "diff": [*copy.diff]}

    async def _reload(self, dry_run: bool, instead: dict[str, str]) -> Json:
        """Read in a thread: a network folder must not hold up the robot."""
        experiment = await asyncio.to_thread(self._load)
        if self._session.ended:
            raise RequestError(Sentence("gate.ending", "the session is ending"))
        difference = compare(without_typed(self._session.experiment), experiment)
        if difference.drivers:
            raise RequestError(
                Sentence(
                    "host.drivers_changed",
                    "the drivers changed: {changes}",
                    changes=functools.reduce(with_remedy, difference.drivers),
                ),
                Sentence(
                    "host.start_anew",
                    "end the session and start it again to use other drivers",
                ),
            )
        reread = await asyncio.to_thread(self._session.reread, experiment, dry_run=dry_run)
        changes = [*difference.changes, *reread]
        telling = [*difference.telling, *reread]
        instead.update(dict.fromkeys(telling, _HIDDEN_CHANGE))
        if self._session.ended:
            raise RequestError(Sentence("gate.ending", "the session is ending"))
        if not dry_run:
            self.server.restrict(experiment)
            self._session.adopt(experiment, [*map(str, changes)], [*map(str, telling)])
            self._session.on_panels()
        return [*changes]


def _with_own_source(client: ClientConnection, request: Request) -> Request:
    """`request` with the source that its connection has. A wizard's console says itself what a
    person used of it; whatever comes from a program is the program's, whatever it says.
    """
    if request.sourced and (
        client.role != "wizard" or getattr(request, "source", "") in NOT_OF_CLIENTS
    ):
        return replace(request, source="program")
    if isinstance(request, AskEnd) and request.reason == "wizard" and client.role == "program":
        return replace(request, reason="program")
    return request


def _finding_data(finding: Finding) -> Json:
    """A finding of the preflight as consoles and programs get it."""
    fields: dict[str, Json] = msgspec.to_builtins(finding, enc_hook=str)
    texts = {"subject": finding.subject, "text": finding.text, "remedy": finding.remedy}
    wording = wording_of(texts)
    return {**fields, "wording": msgspec.to_builtins(wording)} if wording else fields


def _refused(client: ClientConnection, request: Request, error: RequestError) -> Reply:
    """Why not; conditions are listed by the names that the client knows."""
    hint = error.hint
    if client.view is not None and error.conditions:
        hint = Sentence(
            "gate.there_are",
            "there are {names}",
            names=", ".join(client.view.redactor.labels(error.conditions)),
        )
    return Reply(
        ref=request.ref,
        ok=False,
        reason=error.reason,
        hint=hint,
        command=error.command,
        needs=[*error.needs],
    )


def _with_end(client: ClientConnection, reply: Reply, end: ActionEnd | End) -> Reply:
    """The reply to a request that is over already: one that was refused is not called accepted."""
    kind = str(end.__struct_config__.tag)
    if isinstance(end, ActionDone | Done):
        return replace(reply, ended=kind)
    seen = end if client.view is None else client.view.redactor.message(end)
    assert isinstance(seen, ActionEnd | End)
    hint = seen.remedy if isinstance(seen, End) else ""
    return replace(reply, ok=False, reason=seen.reason, hint=hint, ended=kind)


def _redacted(client: ClientConnection, reply: Reply, instead: Mapping[str, str]) -> Reply:
    """What the client may have of an answer."""
    return reply if client.view is None else client.view.redactor.reply(reply, instead)
