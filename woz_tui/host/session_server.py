"""Serves the robot process's socket: who is attached, and who plays which part."""

from __future__ import annotations

import asyncio
import logging
import os
import socket
from collections.abc import Iterable
from pathlib import Path

import msgspec

from woz_tui.config.experiment import Experiment
from woz_tui.gate.facts import console_of
from woz_tui.host.client_connection import (
    LINGER_S,
    ClientConnection,
    RequestScheduler,
    RoleView,
    part_text,
    take_over_hint,
)
from woz_tui.host.dead_man_switch import DeadManSwitch
from woz_tui.host.experiment_view import ExperimentView, plan_for_log, plan_of
from woz_tui.host.request_handlers import RequestHandlers
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.panel_players import player_names
from woz_tui.protocol.requesters import PARTICIPANT
from woz_tui.protocol.requests import (
    PROTOCOL,
    AskAbout,
    AskStop,
    AskTakeOver,
    Beat,
    Hello,
    Pulse,
    Reply,
    Request,
    Welcome,
)
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.redactor import ParticipantRedactor, Redactor, sees_everything
from woz_tui.session.session import Session
from woz_tui.session.session_plan import panels_changed, study_settings, welcome
from woz_tui.system import session_sockets
from woz_tui.system.clock import boot_id

PULSE_S = 1.0
#: Dead-man periods of silence after which a wizard's connection is given up altogether.
SILENT_PERIODS = 5
ROLES = ("wizard", "watcher", "program", PARTICIPANT)
#: Longest name of an access file that is told, in characters.
LONGEST_VIA = 40
STREAMS = ("everything", "actions", "nothing")

log = logging.getLogger(__name__)


class SessionServer:
    """Serves one session over one socket until it ends.

    Args:
        session: What is served.
        path: Of the socket, which is removed at the end.
        handlers: Answers what is asked of the session.
        pulse_s: Seconds between two looks at beats and clients.
    """

    def __init__(
        self, session: Session, path: Path, handlers: RequestHandlers, pulse_s: float = PULSE_S
    ) -> None:
        self.session = session
        self._pulse_s = pulse_s
        self.path = path
        self.handlers = handlers
        self._clients: list[ClientConnection] = []
        self._turns = RequestScheduler()
        self._count = 0
        self._listener: socket.socket | None = None
        self._server: asyncio.Task[None] | None = None
        self._file: tuple[int, int] | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._alone_us = 0
        self._wizard_came = False
        #: Programs keep the session up whoever else comes and goes: it was begun for one.
        self.for_program = False
        self._views: dict[str, RoleView] = {}
        for role, redactor in (("wizard", Redactor()), (PARTICIPANT, ParticipantRedactor())):
            redactor.adopt(study_settings(session.experiment))
            view = RoleView(redactor, session.state.messages(), session.recent.lines)
            view.listen(session.hub)
            self._views[role] = view
        self._over: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        session.on_panels = self._panels_changed
        handlers.server = self
        self._switch = handlers.switch = DeadManSwitch(session, lambda: self.wizards)

    # -- running -----------------------------------------------------------------------------

    def listen(self, listener: socket.socket) -> None:
        """Serve whoever connects to `listener`, a non-blocking Unix socket."""
        self._alone_us = self.session.hub.now()
        self.session.hub.publish(plan_for_log(ExperimentView.of(self.session)))
        self._open_socket(listener)
        self._pulse()

    async def serve(self) -> str:
        """Until the session is to end; returns why."""
        return await self._over

    def end(self, reason: str) -> None:
        """Let `serve` return."""
        if not self._over.done():
            self._over.set_result(reason)

    async def close(self) -> None:
        """Close the socket and every connection; who reads gets the log's last lines."""
        if self._timer is not None:
            self._timer.cancel()
        self._close_socket()
        if self._file is not None and session_sockets.inode(self.path) == self._file:
            self.path.unlink(missing_ok=True)
        leaving = [client.closed for client in self._clients]
        for client in self._clients:
            client.close("session ended")
        if leaving:
            await asyncio.wait(leaving, timeout=2 * LINGER_S)

    # -- the door ----------------------------------------------------------------------------

    def _open_socket(self, listener: socket.socket) -> None:
        self._listener = listener
        self._file = session_sockets.inode(self.path)
        self._server = asyncio.get_running_loop().create_task(self._accept(listener))

    def _close_socket(self) -> None:
        if self._server is not None:
            self._server.cancel()
        if self._listener is not None:
            self._listener.close()

    def _renew_socket(self) -> None:
        """Bind again when the socket's file is gone.

        The runtime folder goes with the user's last login, such as a dropped SSH line, and is
        there again with the next one, which is just when somebody wants to attach.
        """
        if session_sockets.inode(self.path) is not None:
            return
        try:
            listener = session_sockets.bind(self.path)
        except OSError:  # its folder is gone as well: with the next pulse, perhaps
            return
        self._close_socket()
        self._open_socket(listener)
        log.warning("the socket %s was gone and has been made again", self.path)

    async def _accept(self, listener: socket.socket) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                connection, _ = await loop.sock_accept(listener)
                await self._admit(connection)
            except OSError:
                # Out of file descriptors, most likely: the session goes on, a newcomer waits.
                log.exception("a connection could not be accepted")
                await asyncio.sleep(1.0)

    async def _admit(self, connection: socket.socket) -> None:
        if session_sockets.peer_uid(connection) not in {os.getuid(), 0}:
            connection.close()
            return
        self._count += 1
        client = ClientConnection(
            f"con{self._count}",
            self.session.hub,
            self._turns,
            self.session.standstill,
            on_request=self._request,
            on_stop=self._stop,
            on_close=self._on_close,
            recorded=self.session.recorder.is_written,
        )
        await asyncio.get_running_loop().connect_accepted_socket(lambda: client, connection)

    # -- clients -----------------------------------------------------------------------------

    @property
    def wizards(self) -> list[ClientConnection]:
        """The consoles that play the robot, each its part."""
        return [client for client in self._clients if client.role == "wizard"]

    def _player(self, part: str) -> ClientConnection | None:
        return next((client for client in self.wizards if client.part == part), None)

    def _free_part(self, client: ClientConnection) -> str | None:
        """The part that a console which watches can take over: its own, or without one whichever
        nobody plays; None: all who play respond.
        """
        if (present := self._player(client.part)) is None or present.silent:
            free: str | None = client.part
        else:
            free = None
        if client.part:
            return free
        if silent := next((each for each in self.wizards if each.silent), None):
            return silent.part
        parts = self.session.experiment.parts
        played = bool(self.wizards) and all(self._player(part) for part in parts)
        return None if played else free

    def can_take_over(self, client: ClientConnection) -> bool:
        """Whether a console that watches could play: there is a part that nobody plays."""
        return self._free_part(client) is not None

    @property
    def alone(self) -> bool:
        """Whether nobody who is attached keeps the session up."""
        return not any(map(self._keeps_up, self._clients))

    def _keeps_up(self, client: ClientConnection) -> bool:
        """Consoles keep it up, a wizard's while it has its terminal. Programs do until the first
        wizard has come: then they expect one, and would go on with a robot that nobody minds.
        Somebody who answers questions, or listens, minds no robot, nor does a client at which
        nobody sits.
        """
        if client.hello is None or client.hello.unattended:
            return False
        match client.role:
            case "wizard":
                return client.line_ok
            case "watcher":
                return client.hello.stream != "nothing"
            case "program":
                return self.for_program or not self._wizard_came
        return False

    def _request(self, client: ClientConnection, request: Request) -> None:
        if isinstance(request, AskStop):  # before everything: it needs no hello and no role
            self._stop(client, request)
            client.send(Reply(ref=request.ref, ok=True))
        elif isinstance(request, AskAbout):  # neither does the question which session this is
            session = self.session
            about: Json = {
                "session": session.identity.session,
                "title": session.experiment.title,
                "participant": session.identity.participant,
            }
            client.send(Reply(ref=request.ref, ok=True, data=about))
        elif isinstance(request, Hello):
            self._hello(client, request)
        elif client.hello is None:
            client.refuse(request.ref, Sentence("host.hello_first", "say hello first"))
        elif isinstance(request, Beat):
            self._beat(client, request.line_ok)
        elif isinstance(request, AskTakeOver):
            self._take_over(client, request)
        else:
            self.handlers.answer(client, request)

    def _stop(self, client: ClientConnection, request: AskStop) -> None:
        with self.session.hub.on_behalf_of(client.name):
            source = (
                Sentence("host.participant", "the participant")
                if client.role == PARTICIPANT
                else request.source
            )
            self.session.stop(source, request.sent_us)

    def _hello(self, client: ClientConnection, hello: Hello) -> None:
        if hello.protocol != PROTOCOL:
            client.refuse(
                hello.ref,
                Sentence(
                    "host.other_protocol",
                    "this robot process speaks protocol {protocol}, not {asked}",
                    protocol=PROTOCOL,
                    asked=hello.protocol,
                ),
                Sentence(
                    "host.same_version",
                    "use console and robot process of the same version",
                ),
            )
            client.close("protocol")
            return
        if hello.role not in ROLES or client.hello is not None:
            reason = (
                Sentence("host.hello_again", "hello was already sent")
                if client.hello
                else Sentence("host.no_role", "no role {role!r}", role=hello.role)
            )
            client.refuse(hello.ref, reason, ", ".join(ROLES))
            return
        if hello.stream not in STREAMS:
            client.refuse(
                hello.ref,
                Sentence("host.no_stream", "no stream {stream!r}", stream=hello.stream),
                ", ".join(STREAMS),
            )
            return
        if hello.sees == "all" and hello.role != "program":
            reason = Sentence(
                "host.only_programs_see_all",
                "only a program can see everything; the wizard's screen then shows its name",
            )
            client.refuse(hello.ref, reason, Sentence("host.role_program", "role: program"))
            return
        parts = self.session.experiment.parts
        plays = hello.role in ("wizard", "watcher", "program")
        if hello.part and not (plays and hello.part in parts):
            reason = Sentence("host.no_part_for_role", "only a wizard or a program plays a part")
            if plays:
                reason = Sentence(
                    "host.no_part",
                    "the experiment has no part {part!r}",
                    part=hello.part,
                )
            known = ", ".join(parts)
            hint = (
                Sentence("gate.there_are", "there are {names}", names=known)
                if known
                else Sentence("host.for_gives_part", "a panel's `for` gives it a part")
            )
            client.refuse(hello.ref, reason, hint)
            return
        client.hello, client.part, client.role = hello, hello.part, hello.role
        if hello.role == "wizard" and (present := self._player(hello.part)) is not None:
            if hello.take_over or present.silent:
                self._demote(present, client)
            else:
                client.role = "watcher"
        self._wizard_came |= client.role == "wizard"
        sees_all = sees_everything(client.role, hello.sees)
        client.view = None if sees_all else self._views.get(client.role, self._views["wizard"])
        client.beat_us = self.session.hub.now()
        self._clients.append(client)
        self.session.hub.publish(
            m.ConsoleAttached(
                console=client.name,
                role=client.role,
                name=hello.name if client.role == "program" or hello.unattended else "",
                sees="all" if sees_all else "",
                via=hello.via[:LONGEST_VIA],
                part=client.part,
                line=hello.line,
                driving=self._switch.driving_of(client) if client.role == "wizard" else "",
            )
        )
        client.send(self._welcome(client))
        if hello.stream != "nothing":
            client.follow(samples=hello.stream == "everything")
        self._switch.update()

    def _demote(self, present: ClientConnection, by: ClientConnection) -> None:
        """The console that played watches from now on."""
        present.role = "watcher"
        present.refuse(
            0,
            Sentence(
                "host.taken_over",
                "{name} has taken over; this console now only watches",
                name=by.name,
            ),
        )
        self.session.hub.publish(
            m.ConsoleLost(console=present.name, role="wizard", why="taken over", part=present.part)
        )

    def _take_over(self, client: ClientConnection, request: AskTakeOver) -> None:
        if client.role != "watcher":
            client.refuse(
                request.ref,
                Sentence("host.only_watchers", "only a console that watches can take over"),
            )
            return
        part = self._free_part(client)
        if part is None:
            wizards = self.session.state.wizards
            present = self._player(client.part)
            if present is not None:
                reason = Sentence(
                    "host.part_played",
                    "{wizard} plays {part}",
                    wizard=player_names([present.name], wizards),
                    part=part_text(client),
                )
            else:
                reason = Sentence(
                    "host.all_played",
                    "every part is played: by {wizards}",
                    wizards=player_names(wizards, wizards),
                )
            client.refuse(request.ref, reason, take_over_hint(client))
            return
        if (present := self._player(part)) is not None:
            self._demote(present, client)
        client.role, client.part, client.silent = "wizard", part, ""
        self._wizard_came = True
        client.beat_us = self.session.hub.now()
        assert client.hello is not None  # a watcher has said it
        self.session.hub.publish(
            m.ConsoleAttached(
                console=client.name,
                role="wizard",
                via=client.hello.via[:LONGEST_VIA],
                part=part,
                line=client.hello.line,
                driving=self._switch.driving_of(client),
            )
        )
        self._switch.update()
        client.send(Reply(ref=request.ref, ok=True))

    def restrict(self, experiment: Experiment) -> None:
        """A file is about to be adopted: who is to be blind by it is so before anything is said."""
        study = study_settings(experiment)
        for view in self._views.values():
            if study.blind:
                view.redactor.adopt(study)

    def _welcome(self, client: ClientConnection) -> Welcome:
        session, view = self.session, client.view
        whole = welcome(
            plan_of(ExperimentView.of(session)),
            console=client.name,
            role=client.role,
            seq=session.hub.seq,
            t=session.hub.now(),
            log=str(session.recorder.path),
        )
        state: Iterable[m.Message | None] = session.state.messages(plan=False)
        recent: Iterable[m.Message | None] = session.recent.lines
        if view is not None:
            whole, recent = view.redactor.welcome(whole), view.recent
            state = [view.redactor.message(line) for line in session.state.messages(plan=False)]
        driving = self._switch.driving_of(client)
        return msgspec.structs.replace(
            whole,
            settings=msgspec.structs.replace(whole.settings, driving=driving),
            state=_raw(state),
            recent=_raw(recent),
            boot_id=boot_id(),
            clock_us=-session.hub.t(0),
            part=client.part,
        )

    def _panels_changed(self) -> None:
        shown = ExperimentView.of(self.session)
        self.session.hub.publish(plan_for_log(shown))
        news = panels_changed(plan_of(shown))
        for client in self._clients:
            view = client.view
            own = msgspec.structs.replace(news, driving=self._switch.driving_of(client))
            client.send(own if view is None else view.redactor.panels(own))
        self._switch.update()

    def _on_close(self, client: ClientConnection, why: str) -> None:
        if client not in self._clients:
            return
        was_alone = self.alone
        self._clients.remove(client)
        if not self.session.ended:
            self.session.lose_hands(client.name)
            self.session.hub.publish(
                m.ConsoleLost(console=client.name, role=client.role, why=why, part=client.part)
            )
            self._switch.update()
        if self.alone and not was_alone:
            self._alone_us = self.session.hub.now()

    # -- beats -------------------------------------------------------------------------------

    def _beat(self, client: ClientConnection, line_ok: bool) -> None:
        client.beat_us = self.session.hub.now()
        was_alone, client.line_ok = self.alone, line_ok
        if self.alone and not was_alone:
            self._alone_us = self.session.hub.now()
        why = (
            ""
            if line_ok
            else Sentence(
                "host.terminal_gone",
                "the terminal of {part} is not connected",
                part=console_of(client.part),
            )
        )
        if client.silent != why:
            client.silent = why
            self._switch.update()

    def _pulse(self) -> None:
        # First of all: whatever happens in one round, the dead man's switch goes on.
        self._timer = asyncio.get_running_loop().call_later(self._pulse_s, self._pulse)
        self._renew_socket()
        now = self.session.hub.now()
        settings = self.session.experiment.session
        for wizard in self.wizards:
            silence = (now - wizard.beat_us) / 1_000_000
            if silence > settings.dead_man * SILENT_PERIODS:
                wizard.close("silent")
            elif silence > settings.dead_man and not wizard.silent:
                wizard.silent = Sentence(
                    "host.no_response", "{part} does not respond", part=console_of(wizard.part)
                )
                self._switch.update()
        for client in self._clients:
            client.send(Pulse(t=now, dropped=client.dropped))
        if self.alone and now - self._alone_us > settings.abandon_after * 1_000_000:
            self.end("abandoned")


def _raw(lines: Iterable[m.Message | None]) -> list[msgspec.Raw]:
    return [msgspec.Raw(codec.encode(line).rstrip()) for line in lines if line is not None]
