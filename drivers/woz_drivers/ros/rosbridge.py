"""Operations of rosbridge: what is published and subscribed goes over the robot's line; what waits
for an answer goes over connections of its own.

rosbridge of ROS 2 reads the next operation of a connection only when the service that it calls has
answered, and the goal that it sends has ended. On one connection neither a stop nor a velocity
would get through meanwhile. So each call and each goal takes a connection for itself, a spare one
is kept open, and the line to the robot never waits.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import uuid
from collections.abc import Awaitable, Callable, Coroutine, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import aiohttp
import msgspec

from woz_drivers.lines.web_robot_link import WebRobotLink
from woz_drivers.lines.web_socket_line import WebPlace, resetting_connector
from woz_drivers.programs.simulated_process import SIMULATED, SimulatedProcess
from woz_drivers.ros.message_types import plain, wire_name
from woz_drivers.ros.settings import RosSettings, shown, url
from woz_tui.drivers.background import BackgroundTasks
from woz_tui.drivers.contract import DeviceLostError, DriverContext, DriverError
from woz_tui.protocol.messages import Json
from woz_tui.system.foreign_json import decode_foreign

#: No such service: the server says so at once, and with that how far it has read. One that there is
#: could hang, and until it answers nothing else of the connection is read. Servers that allow some
#: services only always allow those of rosapi.
_NO_SERVICE = "/rosapi/read_so_far"
#: The server must be found to be rosbridge within so many seconds.
_KNOWN_WITHIN_S = 5.0
#: With ROS 2 what is published is lost until publisher and subscriber have found each other: so
#: long after a topic was advertised nothing is published, in seconds.
DISCOVERY_S = 0.5
#: A robot that was heard so lately is alive, in seconds: odometry comes ten times a second.
_JUST_NOW_S = 0.1
#: A further connection may take so long, in seconds.
_CONNECT_S = 3.0
#: A cancellation that came before its goal was accepted is lost: it is repeated, in seconds.
_CANCEL_AGAIN_S = 0.1
#: The result of a goal that was cancelled is waited for so long, in seconds.
_CANCELLED_WITHIN_S = 10.0
#: An action of ROS 2 has told of a goal that it accepts after so long, in seconds.
ACCEPTED_S = 2.0
#: Whether the node of an action, or the listener of a topic, is there is asked so often, and so
#: long the answer is waited for, in seconds.
SERVED_S, _THERE_WITHIN_S = 3.0, 1.0
_UNKNOWN_S = 60.0
#: What rosbridge's own node is called: it advertises and subscribes for us.
_ROSBRIDGE = "rosbridge"
#: Of the server's complaints so many different ones are shown.
_MOST_COMPLAINTS = 20
#: States of a goal, by version of ROS: `actionlib_msgs/GoalStatus`, `action_msgs/GoalStatus`.
_SUCCEEDED = {1: 3, 2: 4}
_CANCELLED = {1: (2, 8), 2: (5,)}
_ENDED_BADLY = {1: {4: "aborted", 5: "refused", 9: "lost"}, 2: {6: "aborted", 0: "not carried out"}}
_UNANSWERED = (
    "look at the robot's own node; after a stop or a restart of rosbridge it may still do it"
)

log = logging.getLogger(__name__)


class ServiceFailedError(DriverError):
    """rosbridge answered that a service could not be called, or a goal not be sent."""


@dataclass(eq=False)
class SentGoal:
    """A goal that was sent.

    Attributes:
        ended: Has its state and its result.
        accepted: False when nothing said in time that the robot took it.
        cancelling: Cancels it, and ends when its result has come.
    """

    ident: str
    action: str
    kind: str
    ended: asyncio.Future[tuple[int, Json]]
    accepted: bool = True
    cancelling: asyncio.Task[None] | None = None


Handler = Callable[[Mapping[str, Any]], None]


class Rosbridge(WebRobotLink):
    """One robot. Made in the event loop; begins with `start`, ends with `close`.

    `get_ready` is awaited after each opening, once the server has answered and everything is
    advertised and subscribed; it returns what is shown of the connected robot. `on_lost` is called
    when a connection has ended.
    """

    def __init__(
        self,
        settings: RosSettings,
        context: DriverContext,
        simulated: Iterable[str],
        *,
        get_ready: Callable[[], Awaitable[str]],
        on_lost: Callable[[DeviceLostError], None],
    ) -> None:
        process = SimulatedProcess("robot_simulators.rosbridge", tuple(simulated), context.folder)
        super().__init__(context, shown(settings.address), process)
        self._settings = settings
        self._ros = settings.ros
        self._robot_ready = get_ready
        self._robot_lost = on_lost
        self._url = url(settings.address)
        #: The server's address as the line found it last.
        self._found = ""
        #: Loop time at which anything came from the robot last.
        self._heard = float("-inf")
        self._advertised: dict[str, str] = {}
        self._handlers: dict[str, list[Handler]] = {}
        self._subscribed: dict[str, tuple[str, float]] = {}
        self._waiting: dict[str, asyncio.Future[Mapping[str, Any]]] = {}
        #: Those that wait for something which nobody says any more when the robot is lost.
        self._watching: set[asyncio.Future[None]] = set()
        self.goals: dict[str, SentGoal] = {}
        #: Of actions of ROS 2 that have told it: the goals that they have accepted.
        self._accepted: dict[str, frozenset[str]] = {}
        #: Whether somebody is there, and until when that is believed, by `publishers` or
        #: `subscribers` and topic.
        self._there: dict[tuple[str, str], tuple[bool | None, float]] = {}
        #: Of the further connections; another one after each loss.
        self._session: aiohttp.ClientSession | None = None
        self._spare: aiohttp.ClientWebSocketResponse[bool] | None = None
        self._in_use: set[aiohttp.ClientWebSocketResponse[bool]] = set()
        self._complaints: set[str] = set()
        self._background = BackgroundTasks("something for the robot")
        #: Those that close connections: they are not broken off.
        self._closing = BackgroundTasks("closing connections")

    # -- its life ------------------------------------------------------------------------------

    def advertise(self, topic: str, kind: str) -> None:
        """Say at each opening that messages will be published. Before `start`."""
        self._advertised[topic] = wire_name(kind, self._ros, "msg")

    def subscribe(self, topic: str, kind: str, handler: Handler, throttle_s: float = 0.0) -> None:
        """Have `handler` called with each message of a topic. Before `start`."""
        self._handlers.setdefault(topic, []).append(handler)
        before = self._subscribed.get(topic, ("", throttle_s))
        self._subscribed[topic] = (
            wire_name(kind, self._ros, "msg"),
            min(before[1], throttle_s),
        )

    def use_action(self, action: str, kind: str) -> None:
        """Be ready to send goals. Before `start`. With ROS 1 an action is a set of topics."""
        if self._ros == 1:
            base = plain(kind).removesuffix("Action")
            self.advertise(f"{action}/goal", f"{base}ActionGoal")
            self.advertise(f"{action}/cancel", "actionlib_msgs/GoalID")
            self.subscribe(f"{action}/result", f"{base}ActionResult", self._actionlib_result)
            return

        def on_status(message: Mapping[str, Any]) -> None:
            self._accepted[action] = _goals_of(message)

        self.subscribe(f"{action}/_action/status", "action_msgs/GoalStatusArray", on_status)

    async def close(self) -> None:
        """Let go of the robot."""
        await self._background.close(0.0)
        self._forget(DeviceLostError("the robot's driver is closed"))
        await self._line.close()
        self._hang_up()
        await self._closing.settled()
        await self._simulated.close()

    def later(self, work: Coroutine[Any, Any, Any]) -> asyncio.Task[Any]:
        """Do something that nobody needs to wait for, and whose failure is no surprise. It is
        broken off by `close` only: what it sends after a loss raises `DeviceLostError`.
        """
        return self._background.start(work)

    async def unless_lost(self, work: Coroutine[Any, Any, None]) -> None:
        """Wait for `work`. Raises `DeviceLostError` when the robot goes meanwhile."""
        working = asyncio.ensure_future(work)
        lost: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._watching.add(lost)
        try:
            self.need()
            await asyncio.wait({working, lost}, return_when=asyncio.FIRST_COMPLETED)
            await (working if working.done() else lost)
        finally:
            self._watching.discard(lost)
            working.cancel()

    async def alive(self, within: float) -> None:
        """Return if the robot was heard just now, else when it has answered a ping: a velocity must
        not lie in a robot that is frozen. Raises `DriverError`.
        """
        if asyncio.get_running_loop().time() - self._heard > _JUST_NOW_S:
            await self._line.probe(within)

    async def _find(self) -> WebPlace:
        self._found = self._url or f"ws://{await self._simulated.address()}/"
        secure, _, rest = self._found.partition("://")
        host, slash, path = rest.partition("/")
        return WebPlace(host, slash + path, secure == "wss")

    async def _get_ready(self) -> str:
        for topic, kind in self._advertised.items():
            await self._line.send(
                {"op": "advertise", "id": f"advertise {topic}", "topic": topic, "type": kind}
            )
        for topic, (kind, throttle_s) in self._subscribed.items():
            await self._line.send(
                {
                    "op": "subscribe",
                    "id": f"subscribe {topic}",
                    "topic": topic,
                    "type": kind,
                    "throttle_rate": round(throttle_s * 1000),
                    "queue_length": 1,
                }
            )
        try:
            await self.wait_until_processed(_KNOWN_WITHIN_S)
        except TimeoutError:
            raise DriverError(
                f"{self.shown} answers, but not as rosbridge does",
                "check its port; is rosbridge still starting?",
            ) from None
        self._spare = await self._connect()
        if self._ros == 2 and self._settings.address != SIMULATED:
            await asyncio.sleep(DISCOVERY_S)
        return await self._robot_ready()

    def _lost(self, error: DeviceLostError) -> None:
        self._forget(error)
        self._hang_up()
        self._robot_lost(error)

    def _forget(self, why: DeviceLostError) -> None:
        """Nothing that is under way will be answered any more."""
        futures: list[asyncio.Future[Any]] = [*self._waiting.values(), *self._watching]
        futures += [goal.ended for goal in self.goals.values()]
        for future in futures:
            if not future.done():
                future.set_exception(DeviceLostError(why.what, why.remedy))
                future.exception()  # perhaps nobody waits for it any more
        self.goals.clear()

    def _hang_up(self) -> None:
        """End all further connections: on one that is still opening nothing is sent any more."""
        session, self._session = self._session, None
        opened = [*self._in_use, *([self._spare] if self._spare is not None else [])]
        self._spare = None
        if session is not None:
            self._closing.start(_close(session, opened))

    # -- messages --------------------------------------------------------------------------------

    def _take(self, message: Any) -> None:
        self._heard = asyncio.get_running_loop().time()
        if not isinstance(message, dict):
            raise ValueError(f"no operation: {message!r:.80}")
        match message.get("op"):
            case "publish":
                content = message.get("msg")
                if not isinstance(content, dict):
                    raise ValueError("a message without fields")
                for handler in self._handlers.get(str(message.get("topic")), ()):
                    handler(content)
            case "service_response":
                waiting = self._waiting.get(str(message.get("id")))
                if waiting is not None and not waiting.done():
                    waiting.set_result(message)
            case "status":
                if message.get("level") == "error":
                    self._complained(f"{message.get('msg')!s:.200}")
            case operation:
                raise ValueError(f"unknown operation {operation!r:.80}")

    def _complained(self, words: str) -> None:
        """A message that is refused comes ten times a second while a command drives."""
        if words not in self._complaints and len(self._complaints) < _MOST_COMPLAINTS:
            self._complaints.add(words)
            self._context.notice("warning", f"rosbridge says: {words}")

    async def publish(self, topic: str, message: Json) -> None:
        """Publish a message. Raises `DeviceLostError`."""
        await self._line.send({"op": "publish", "topic": topic, "msg": message})

    async def wait_until_processed(self, within: float = 1.0) -> None:
        """Return when the server has carried out everything that was sent over the line.

        It carries out one operation after the other, so it is asked for a service that is not
        there. Raises TimeoutError, `DeviceLostError`.
        """
        ident = uuid.uuid4().hex
        answer = self._waiting[ident] = asyncio.get_running_loop().create_future()
        try:
            async with asyncio.timeout(within):
                await self._line.send({"op": "call_service", "id": ident, "service": _NO_SERVICE})
                await answer
        finally:
            self._waiting.pop(ident, None)

    # -- calls and goals -----------------------------------------------------------------------

    async def _connect(self) -> aiohttp.ClientWebSocketResponse[bool]:
        """A further connection to the robot that is there now.

        Raises:
            DeviceLostError: The robot is not there, or was lost meanwhile.
            DriverError: It takes no further connection.
        """
        self._line.need()
        if self._session is None:
            self._session = aiohttp.ClientSession(connector=resetting_connector())
        session = self._session
        try:
            async with asyncio.timeout(_CONNECT_S):
                opened = await session.ws_connect(
                    self._found,
                    max_msg_size=1 << 26,
                    timeout=aiohttp.ClientWSTimeout(ws_close=0.1),
                )
        except (TimeoutError, aiohttp.ClientError, OSError, RuntimeError) as error:
            raise await self._trouble(
                session, f"takes no further connection: {_reason(error)}"
            ) from None
        if self._session is not session:
            self._closing.start(opened.close())
            raise await self._trouble(session, "was lost")
        return opened

    async def _trouble(self, session: aiohttp.ClientSession | None, what: str) -> DriverError:
        """What happened to a connection of `session`: a loss of the robot, if that is lost."""
        try:
            await self._line.probe()
        except DeviceLostError as error:
            return error
        if self._session is not session:
            return DeviceLostError(f"{self.shown} was lost meanwhile", "try again")
        return DriverError(f"{self.shown} {what}", "look at rosbridge and at the robot's own node")

    async def _ask(self, message: dict[str, Json], end: str, within: float) -> Mapping[str, Any]:
        """Send an operation over a connection of its own; returns the answer to it.

        Raises TimeoutError, `DriverError`.
        """
        opened, self._spare = self._spare, None
        session, answered = self._session, False
        try:
            async with asyncio.timeout(within):
                if opened is None or opened.closed:
                    opened = await self._connect()
                    session = self._session
                self._in_use.add(opened)
                await opened.send_str(msgspec.json.encode(message).decode())
                while (answer := await _read(opened)) is not None:
                    if answer.get("op") == end and answer.get("id") == message["id"]:
                        answered = True
                        return answer
        except (ConnectionError, RuntimeError):
            pass
        finally:
            if opened is not None:
                self._in_use.discard(opened)
                self._put_back(opened, answered)
        raise await self._trouble(session, "broke off the connection of a call")

    def _put_back(self, opened: aiohttp.ClientWebSocketResponse[bool], answered: bool) -> None:
        """Keep a connection for the next call; on one without an answer the server may go on for
        long, so another one is made.
        """
        if answered and not opened.closed and self._spare is None and self.ready:
            self._spare = opened
            return
        self._closing.start(opened.close())
        if self._spare is None and self.ready:
            self.later(self._refill())

    async def _refill(self) -> None:
        fresh = await self._connect()
        if self._spare is None:
            self._spare = fresh
        else:
            self._closing.start(fresh.close())

    async def call(self, service: str, request: Json, within: float = 3.0) -> Any:
        """The answer of a service.

        Raises:
            ServiceFailedError: The server could not call it, in its words.
            DeviceLostError: The robot went away.
            DriverError: It did not answer in time, or broke the call off.
        """
        message = {
            "op": "call_service",
            "id": uuid.uuid4().hex,
            "service": service,
            "args": request,
        }
        try:
            answer = await self._ask(message, "service_response", within)
        except TimeoutError:
            raise DriverError(
                f"{service} did not answer within {within:g} s", _UNANSWERED
            ) from None
        if answer.get("result") is not True:
            raise ServiceFailedError(
                f"{service}: {answer.get('values')!s:.200}", "is its node running?"
            )
        return answer.get("values")

    async def send_goal(self, action: str, kind: str, goal: Json, within: float) -> Json:
        """Send a goal and return its result when it has succeeded.

        Raises:
            DriverError: It ended otherwise, or not in time; then it is cancelled.
            DeviceLostError: The robot went away.
        """
        ended: asyncio.Future[tuple[int, Json]] = asyncio.get_running_loop().create_future()
        sent = SentGoal(f"woz-{uuid.uuid4().hex}", action, kind, ended)
        self.goals[sent.ident] = sent
        before = self._accepted.get(action, frozenset({"none was told of yet"}))
        asking = self.later(self._ask_goal(sent, goal, within))
        try:
            async with asyncio.timeout(within):
                await asyncio.wait([ended], timeout=ACCEPTED_S)
                if not ended.done() and self._accepted.get(action) == before:
                    # The server of ROS 2 never answers then.
                    sent.accepted = False
                    raise DriverError(
                        f"{action} did not accept its goal", "does the robot know what it names?"
                    )
                while not ended.done():
                    await self._need_server(sent)
                    await asyncio.wait([ended], timeout=SERVED_S)
                status, result = await asyncio.shield(ended)
        except TimeoutError:
            raise DriverError(f"{action} did not end within {within:g} s", _UNANSWERED) from None
        finally:
            if ended.done():
                self.goals.pop(sent.ident, None)
                asking.cancel()
            else:
                self._begin_to_cancel(sent)
        if status == _SUCCEEDED[self._ros]:
            return result
        if status in _CANCELLED[self._ros]:
            raise DriverError(f"{action} was cancelled on the robot")
        how = _ENDED_BADLY[self._ros].get(status, f"ended in state {status}")
        raise DriverError(f"{action} was {how}: {result!s:.200}", "look at the robot's own node")

    async def _need_server(self, goal: SentGoal) -> None:
        """Raises `DriverError` if no node carries the goal's action out (any more)."""
        status = f"{goal.action}/{'_action/' if self._ros == 2 else ''}status"
        if await self.is_there("publishers", status) is False:
            goal.accepted = False
            raise DriverError(
                f"no node of the robot carries out {goal.action}",
                "start its node again: it is not there, or has ended",
            )

    async def is_there(self, who: str, topic: str) -> bool | None:
        """Whether a topic has `publishers` or `subscribers` beside rosbridge itself, by the word of
        rosapi; None: it does not say. What was there lately is not asked about again, nor for a
        while a rosapi that does not know.
        """
        name = topic if topic.startswith("/") else f"/{topic}"
        now = asyncio.get_running_loop().time()
        known, until = self._there.get((who, name), (None, float("-inf")))
        if now < until:
            return known
        try:
            answer = await self.call(f"/rosapi/{who}", {"topic": name}, _THERE_WITHIN_S)
        except DeviceLostError:
            raise
        except DriverError:
            answer = None
        nodes = answer.get(who) if isinstance(answer, dict) else None
        if not isinstance(nodes, list):
            self._there[who, name] = None, now + _UNKNOWN_S
            return None
        there = any(_ROSBRIDGE not in str(node) for node in nodes)
        if there:
            self._there[who, name] = True, now + SERVED_S
        return there

    async def _ask_goal(self, goal: SentGoal, content: Json, within: float) -> None:
        message = {
            "op": "send_action_goal",
            "id": goal.ident,
            "action": goal.action,
            "action_type": wire_name(goal.kind, 2, "action"),
            "args": content,
        }
        try:
            if self._ros == 1:
                ident = {"stamp": {"secs": 0, "nsecs": 0}, "id": goal.ident}
                await self.publish(f"{goal.action}/goal", {"goal_id": ident, "goal": content})
                return
            answer = await self._ask(message, "action_result", within + 5.0)
        except (DriverError, TimeoutError) as error:
            with contextlib.suppress(DeviceLostError):
                await self._publish_cancellation(goal)  # nobody would hear of its end
            if not goal.ended.done():
                goal.ended.set_exception(
                    error if isinstance(error, DriverError) else DriverError("no answer")
                )
                goal.ended.exception()  # perhaps nobody waits for it any more
            return
        if not goal.ended.done():
            failed = answer.get("result") is not True
            status = 0 if failed else answer.get("status")
            goal.ended.set_result((status if isinstance(status, int) else 0, answer.get("values")))

    def _actionlib_result(self, message: Mapping[str, Any]) -> None:
        status = message.get("status")
        if not isinstance(status, dict) or not isinstance(status.get("goal_id"), dict):
            raise ValueError("a result without a goal")
        goal = self.goals.get(str(status["goal_id"].get("id")))
        if goal is not None and not goal.ended.done():
            code = status.get("status")
            text = status.get("text")
            result = message.get("result") or {}
            bad = code != _SUCCEEDED[1] and text
            goal.ended.set_result((code if isinstance(code, int) else 0, text if bad else result))

    async def cancel(self, goal: SentGoal) -> None:
        """End a goal; returns when its result has come, which says that it has ended. Raises
        `DriverError` when none comes.
        """
        await asyncio.shield(self._begin_to_cancel(goal))

    def _begin_to_cancel(self, goal: SentGoal) -> asyncio.Task[None]:
        if goal.cancelling is None:
            goal.cancelling = self.later(self._cancel(goal))
        return goal.cancelling

    async def _cancel(self, goal: SentGoal) -> None:
        try:
            async with asyncio.timeout(_CANCELLED_WITHIN_S):
                while not goal.ended.done():
                    await self._publish_cancellation(goal)
                    await asyncio.wait([goal.ended], timeout=_CANCEL_AGAIN_S)
        except TimeoutError:
            what = f"{goal.action} did not say within {_CANCELLED_WITHIN_S:g} s that it has ended"
            if goal.accepted:  # otherwise its command has said enough
                self._context.notice("warning", what, "look at the robot and at its own node")
            raise DriverError(what, "look at the robot and at its own node") from None
        finally:
            self.goals.pop(goal.ident, None)

    async def _publish_cancellation(self, goal: SentGoal) -> None:
        if self._ros == 1:
            await self.publish(f"{goal.action}/cancel", {"id": goal.ident})
            return
        await self._line.send({"op": "cancel_action_goal", "id": goal.ident, "action": goal.action})

    async def cancel_all(self, action: str) -> None:
        """End everything that an action is doing, whoever asked for it. Raises `DriverError`."""
        if self._ros == 1:
            # The server puts its time in: a goal that comes behind a late cancellation goes on.
            await self.publish(f"{action}/cancel", {"stamp": "now", "id": ""})
        else:
            with contextlib.suppress(ServiceFailedError):  # without its server nothing goes on
                await self.call(f"{action}/_action/cancel_goal", {}, within=1.0)


def _goals_of(message: Mapping[str, Any]) -> frozenset[str]:
    """The goals in an `action_msgs/GoalStatusArray`."""
    goals = message.get("status_list")
    if not isinstance(goals, list):
        raise ValueError("a status without goals")
    return frozenset(str(one.get("goal_info")) for one in goals if isinstance(one, dict))


async def _close(
    session: aiohttp.ClientSession, opened: Iterable[aiohttp.ClientWebSocketResponse[bool]]
) -> None:
    await asyncio.gather(*(one.close() for one in opened), return_exceptions=True)
    await session.close()


def _reason(error: BaseException) -> str:
    """In words that do not repeat the address, which may have a password in it."""
    if isinstance(error, aiohttp.WSServerHandshakeError):
        return f"{error.status} {error.message}"
    return str(error) or "it does not answer"


async def _read(opened: aiohttp.ClientWebSocketResponse[bool]) -> Mapping[str, Any] | None:
    """The next message with fields; None when the connection has ended."""
    while True:
        message = await opened.receive()
        if message.type not in (aiohttp.WSMsgType.TEXT, aiohttp.WSMsgType.BINARY):
            return None
        with contextlib.suppress(ValueError):
            found = decode_foreign(message.data)
            if isinstance(found, dict):
                return found
