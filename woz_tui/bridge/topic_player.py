"""Plays what a planner says on the topics of a robot, in a session, and says what comes of it."""

from __future__ import annotations

import asyncio
import contextlib
import functools
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

from woz_tui.bridge.ros_data import RosDataError, RosValue, typed
from woz_tui.bridge.saliency import SILENCE_S, SaliencyMap
from woz_tui.bridge.sequence_queue import (
    NackReason,
    QueuedSequence,
    RequestKind,
    SequenceQueue,
    SequenceRequest,
)
from woz_tui.bridge.topic_table import (
    MIDDLE,
    SalientPlace,
    TakenTopic,
    TopicTable,
    VerbWithArgs,
    salient_places,
    sequence_verb,
)
from woz_tui.client import WozClient, WozError, WozRefusedError, WozSupersededError
from woz_tui.client.woz_client import WozRun
from woz_tui.protocol import messages as m
from woz_tui.protocol.action_messages import HANDS
from woz_tui.system.tasks import TaskSet, end_tasks, until_first_ends

#: `type`, `message` and `reason` of feedback (`feedbackConstants.hpp` of the robot's own software).
_FEEDBACK, _PROGRESS = 1, 2
_NACK, _ACK = 0, 1
_START, _STROKE, _END = 1, 2, 3
#: What was refused is tried again after so many seconds, if the planner still says the same.
RETRY_S = 1.0
#: A place that is nearer than this to the last one is the same; of -1 to 1.
NEAR = 0.02
#: What the wizard's hand has moved is the wizard's for so long, in seconds.
HAND_S = 3.0
#: The planner is told where the robot looks at most so often, in seconds.
GAZE_EVERY_S = 0.1
#: And how the robot is.
REPORT_EVERY_S = 0.05
#: Commands that began before their request was answered.
_EARLY = 64
#: Requests to end a sequence that wait for their moment.
_MOST_ENDINGS = 64

Answer = Callable[[str, Mapping[str, RosValue]], None]


class TopicPlayer:
    """One robot, and the planners that speak on its topics.

    Args:
        client: The session.
        table: What its messages mean.
        answer: Sends the fields of a message on a topic.
        complain: Gets a sentence about what cannot be played.
    """

    def __init__(
        self,
        client: WozClient,
        table: TopicTable,
        answer: Answer,
        complain: Callable[[str], None],
    ) -> None:
        self._client = client
        self._table = table
        self._answer = answer
        self._complain = complain
        self._hands = _Hands(client)
        self._states = _States(client, self._hands, complain)
        self._sequences = _Sequences(client, self._hands, self._general, complain)
        self._gaze = _Gaze(client, self._hands, table, self._tell_gaze, complain)
        self._report = _Report(client, table, answer, complain)

    async def run(self) -> None:
        """Follow the session until it ends or this is cancelled. Raises `WozConnectionError`."""
        looking, reporting = self._gaze.run(self._sequences.idle), self._report.run()
        try:
            await until_first_ends(self._sequences.follow(), looking, reporting)
        finally:
            await self._sequences.close()

    async def take(self, topic: str, message: Mapping[str, RosValue]) -> None:
        """A message on one of the table's topics. Raises `RosDataError`."""
        entry = self._table.takes[topic]
        try:
            read = typed(message, entry.fields)
            if entry.looks is not None:
                self._gaze.put(str(read["inputId"]), salient_places(read))
            elif entry.sequences:
                await self._take_sequence(entry, read)
            else:
                played = await self._states.play(topic, entry, read)
                if entry.acknowledges:
                    self._acknowledge(read, None if played else NackReason.FLUENCY)
        except RosDataError:
            ident = message.get("id")
            if (entry.sequences or entry.acknowledges) and isinstance(ident, str):
                self._acknowledge({"id": ident}, NackReason.INVALID)
            raise

    # -- sequences -------------------------------------------------------------------------------

    async def _take_sequence(self, entry: TakenTopic, read: Mapping[str, Any]) -> None:
        now = self._client.now()  # what is asked for counts from here, however long this takes
        call = sequence_verb(entry, read)
        if call is None:
            taken = self._sequences.end_at(now + max(0.0, read["request"]))
            self._acknowledge(read, None if taken else NackReason.FLUENCY)
            return
        try:
            lasts, stroke = await self._foreseen(call)
        except WozRefusedError as error:
            self._complain(f"{read['id']}: {error}")
            self._acknowledge(read, NackReason.FLUENCY)
            return
        if read["requestType"] == RequestKind.PREDICT:
            fields = {"id": read["id"], "duration": lasts, "stroke": stroke}
            self._tell("prediction", fields)
            return
        request = SequenceRequest(
            read["id"],
            read["requestType"],
            read["request"],
            read["requestCount"],
            lasts,
            stroke,
        )
        placed = self._sequences.queue.add(request, now)
        if isinstance(placed, NackReason):
            self._acknowledge(read, placed)
            return
        try:
            first = await self._sequences.begin(placed, call)
        except WozRefusedError as error:
            self._complain(f"{read['id']}: {error}")
            self._acknowledge(read, NackReason.FLUENCY)
            return
        self._acknowledge(read, None)
        self._sequences.follow_up(placed, call, first)

    async def _foreseen(self, call: VerbWithArgs) -> tuple[float, float]:
        """How long it takes and when its stroke comes, in seconds. Raises `WozRefusedError`."""
        foretold = await self._client.predict(call.verb, call.args)
        if foretold.duration_us is None:
            raise WozRefusedError(f"the robot does not know how long {call.verb} takes", "")
        lasts = foretold.duration_us / 1e6
        marks = foretold.commands[0].marks or ()
        strokes = [mark.at_us / 1e6 for mark in marks if mark.sort == "stroke"]
        return lasts, min(strokes, default=lasts / 2)

    # -- answers ---------------------------------------------------------------------------------

    def _acknowledge(self, message: Mapping[str, Any], nack: NackReason | None) -> None:
        self._general(str(message["id"]), _FEEDBACK, _ACK if nack is None else _NACK, nack or 0)

    def _general(self, ident: str, sort: int, what: int, reason: int = 0) -> None:
        fields: dict[str, RosValue] = {"id": ident, "type": sort, "message": what}
        self._tell("general", {**fields, "reason": int(reason)})

    def _tell_gaze(self, place: SalientPlace) -> None:
        self._tell("gaze", {"x": place.x, "y": place.y})

    def _tell(self, what: str, fields: Mapping[str, RosValue]) -> None:
        for topic, entry in self._table.answers.items():
            if entry.tells == what:
                self._answer(topic, fields)


class _Hands:
    """Which lanes the wizard has used lately: there a planner waits."""

    def __init__(self, client: WozClient) -> None:
        self._client = client
        verbs = reversed(client.description.verbs)
        self._lanes = {(verb.driver, verb.name): verb.lane for verb in client.description.verbs}
        #: Driver and lane of each verb, of the first driver that offers it.
        self._own = {verb.name: (verb.driver, verb.lane) for verb in verbs}
        self._used: dict[tuple[str, str], float] = {}

    def note(self, message: m.Command) -> tuple[str, str] | None:
        """Driver and lane of a command, if it is the wizard's."""
        if message.source not in HANDS or message.source == "program":
            return None
        lane = (message.driver, self._lanes.get((message.driver, message.verb), ""))
        self._used[lane] = self._client.now()
        return lane

    def lane(self, verb: str) -> tuple[str, str]:
        """Driver and lane of a planner's verb."""
        return self._own.get(verb, ("", ""))

    def wait(self, verb: str) -> float:
        """For how many seconds a planner leaves this verb to the wizard."""
        used = self._used.get(self.lane(verb))
        return 0.0 if used is None else max(0.0, used + HAND_S - self._client.now())


class _States:
    """Messages that say again and again how things shall be: what changes is played."""

    def __init__(self, client: WozClient, hands: _Hands, complain: Callable[[str], None]) -> None:
        self._client = client
        self._hands = hands
        self._complain = complain
        #: Arguments as they were last, by topic and place in its list.
        self._last: dict[tuple[str, int], Mapping[str, Any] | None] = {}
        #: When what was refused may be tried again, in seconds of the session.
        self._again: dict[tuple[str, int], float] = {}
        self._ends = TaskSet("bridge state")

    async def play(self, topic: str, entry: TakenTopic, read: Mapping[str, RosValue]) -> bool:
        """Call what differs from before; says whether nothing was refused."""
        taken = True
        for at, call in enumerate([call.of(read) for call in entry.plays]):
            place, now = (topic, at), self._client.now()
            if call is None:
                self._last[place] = None
            elif entry.acknowledges or call.args != self._last.get(
                place, entry.plays[at].before or None
            ):
                early = now < self._again.get(place, 0.0) and not entry.acknowledges
                if early or self._hands.wait(call.verb):
                    taken = False
                    continue
                try:
                    run = await self._client.begin(call.verb, call.args)
                except WozRefusedError as error:
                    self._fail(place, error)
                    taken = False
                    continue
                self._last[place] = call.args
                self._ends.start(self._to_its_end(run, place, entry.plays[at].repeats, call))
        return taken

    async def _to_its_end(
        self, run: WozRun, place: tuple[str, int], repeats: bool, call: VerbWithArgs
    ) -> None:
        """Play it again while it is wanted, if that is how it is meant."""
        try:
            await run
            while repeats and self._last.get(place) == call.args:
                if left := self._hands.wait(call.verb):
                    await asyncio.sleep(left)
                    continue
                run = await self._client.begin(call.verb, call.args)
                await run
        except WozSupersededError:  # that is what states are for
            pass
        except WozError as error:
            self._fail(place, error)

    def _fail(self, place: tuple[str, int], error: WozError) -> None:
        """Complain, and try it again in a while, if it is still wanted then."""
        self._complain(f"{place[0]}: {error}")
        self._last[place], self._again[place] = None, self._client.now() + RETRY_S


class _Gaze:
    """Looks at what is most salient, and home when that has been silent for a while."""

    def __init__(
        self,
        client: WozClient,
        hands: _Hands,
        table: TopicTable,
        tell: Callable[[SalientPlace], None],
        complain: Callable[[str], None],
    ) -> None:
        self._client = client
        self._hands = hands
        self._table = table
        self._tell = tell
        self._complain = complain
        self._map = SaliencyMap()
        self._place = MIDDLE
        self._heard = asyncio.Event()
        self._told = 0.0
        self._ends = TaskSet("bridge gaze")

    def put(self, program: str, places: list[SalientPlace]) -> None:
        """All that is salient to a program at this moment."""
        now = self._client.now()
        self._map.put(program, places, now)
        self._heard.set()
        if now - self._told >= GAZE_EVERY_S:
            self._told = now
            self._tell(self._map.chosen(now))

    async def run(self, idle: asyncio.Event) -> None:
        """Look, until this is cancelled; while a sequence is played (not `idle`) the look waits."""
        while True:
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(SILENCE_S if self._place != MIDDLE else None):
                    await self._heard.wait()
            await idle.wait()
            self._heard.clear()
            place = self._map.chosen(self._client.now())
            far = max(abs(place.x - self._place.x), abs(place.y - self._place.y))
            if far < NEAR and (place == MIDDLE) == (self._place == MIDDLE):
                continue
            await self._look(place)

    async def _look(self, place: SalientPlace) -> None:
        call = self._table.look(place.x, place.y)
        if call is None:
            return
        if left := self._hands.wait(call.verb):
            await asyncio.sleep(left)
            self._heard.set()
            return
        try:
            run = await self._client.begin(call.verb, call.args)
        except WozRefusedError as error:
            self._complain(f"saliency: {error}")
            await asyncio.sleep(RETRY_S)
            return
        self._ends.start(self._to_its_end(run))
        self._place = place
        self._told = self._client.now()
        self._tell(place)

    async def _to_its_end(self, run: WozRun) -> None:
        try:
            await run
        except WozSupersededError:  # it looks elsewhere now
            pass
        except WozError as error:
            self._complain(f"saliency: {error}")


class _Report:
    """Tells a planner how the robot is, when that has changed."""

    def __init__(
        self,
        client: WozClient,
        table: TopicTable,
        answer: Answer,
        complain: Callable[[str], None],
    ) -> None:
        self._client = client
        self._answer = answer
        self._complain = complain
        self._wrong: dict[str, str] = {}
        self._topics = {
            topic: entry for topic, entry in table.answers.items() if entry.tells == "state"
        }
        #: What the body says of itself; readings by the parts of their names.
        self._state: dict[str, Any] = {}
        self._told: dict[str, Mapping[str, RosValue]] = {}

    async def run(self) -> None:
        """Until this is cancelled, or the session ends. Raises `WozConnectionError`."""
        told = 0.0
        async for message in self._client.messages(m.BodyChanged, m.Reading, held=True):
            self._take(message)
            if self._client.now() - told >= REPORT_EVERY_S:
                told = self._client.now()
                self._tell()

    def _take(self, message: m.Message) -> None:
        match message:
            case m.BodyChanged():
                self._state.update(message.values)
            case m.Reading():
                kind, _, name = message.sensor.partition(".")
                inside = self._state.setdefault(kind, {}) if name else self._state
                if isinstance(inside, dict):
                    inside[name or kind] = message.value

    def _tell(self) -> None:
        for topic, entry in self._topics.items():
            try:
                fields = entry.message(self._state)
            except RosDataError as error:
                if self._wrong.get(topic) != str(error):
                    self._wrong[topic] = str(error)
                    self._complain(f"{topic}: {error}")
                continue
            if fields is not None and fields != self._told.get(topic):
                self._told[topic] = fields
                self._answer(topic, fields)


class _Sequences:
    """Sequences that were accepted: each begins in its time, and the planner hears how it goes."""

    def __init__(
        self,
        client: WozClient,
        hands: _Hands,
        tell: Callable[..., None],
        complain: Callable[[str], None],
    ) -> None:
        self._client = client
        self._hands = hands
        self._tell = tell
        self._complain = complain
        self.queue = SequenceQueue()
        #: Set while nothing is played.
        self.idle = asyncio.Event()
        self.idle.set()
        self._tasks: dict[QueuedSequence, asyncio.Task[None]] = {}
        self._verbs: dict[QueuedSequence, str] = {}
        self._endings = TaskSet("bridge end")
        self._moments: list[float] = []
        #: The sequence of each command that was asked for.
        self._commands: dict[str, QueuedSequence] = {}
        self._early: deque[str] = deque(maxlen=_EARLY)
        self._playing: QueuedSequence | None = None

    async def begin(self, sequence: QueuedSequence, call: VerbWithArgs) -> WozRun:
        """Ask for its first movement. Raises `WozRefusedError`; then it is over."""
        try:
            return await self._movement(call, sequence.start)
        except WozError:
            self.queue.remove(sequence)
            raise

    def follow_up(self, sequence: QueuedSequence, call: VerbWithArgs, first: WozRun) -> None:
        """Tell of it, and ask for the others."""
        task = asyncio.create_task(self._play(sequence, call, first), name="bridge sequence")
        self._tasks[sequence], self._verbs[sequence] = task, call.verb

        def ended(task: asyncio.Task[None]) -> None:
            del self._tasks[sequence], self._verbs[sequence]

        task.add_done_callback(ended)

    def end_at(self, moment: float) -> bool:
        """Cut short what is played at this moment; says whether there is room for one more."""
        if len(self._moments) >= _MOST_ENDINGS:
            return False
        self._moments.append(moment)
        self._endings.start(self._end(moment))
        return True

    async def follow(self) -> None:
        """Tell of beginnings and strokes until the session ends, and give way to the wizard."""
        async for message in self._client.messages(m.Command, m.Dispatched, m.CommandMark):
            match message:
                case m.Command():
                    self._give_way(self._hands.note(message), message)
                case m.Dispatched(command=command):
                    if (sequence := self._commands.get(command)) is not None:
                        self._began(sequence)
                    else:
                        self._early.append(command)
                case m.CommandMark(sort="stroke", command=command):
                    if (sequence := self._commands.get(command)) is not None:
                        self._tell(sequence.id, _PROGRESS, _STROKE)

    def _give_way(self, lane: tuple[str, str] | None, message: m.Command) -> None:
        """End what is played where the wizard asks for something else."""
        playing = self._playing
        if playing is not None and lane == self._hands.lane(self._verbs[playing]):
            self._complain(f'{playing.id}: replaced by "{message.action or message.verb}"')
            self._tasks[playing].cancel()

    async def close(self) -> None:
        """Begin nothing any more; what is played is cut short."""
        await self._endings.close()
        await end_tasks(*self._tasks.values())

    async def _movement(self, call: VerbWithArgs, at: float) -> WozRun:
        """Ask for a movement at its time, or at once if that is over."""
        begin = functools.partial(self._client.begin, call.verb, call.args, when_busy="queue")
        if at <= self._client.now():
            return await begin()
        try:
            return await begin(at=at)
        except WozRefusedError:
            if at > self._client.now():
                raise
            return await begin()  # the moment passed on the way to the session

    async def _play(self, sequence: QueuedSequence, call: VerbWithArgs, run: WozRun) -> None:
        try:
            await self._to_its_end(sequence, run)
            for number in range(1, sequence.count):
                run = await self._movement(call, sequence.start + number * sequence.lasts)
                await self._to_its_end(sequence, run)
        except WozError as error:
            self._complain(f"{sequence.id}: {error}")
            if self._playing is not sequence:
                self._tell(sequence.id, _FEEDBACK, _NACK, NackReason.FLUENCY)
        finally:
            if self._playing is sequence:
                self._playing = None
                self.idle.set()
                self._tell(sequence.id, _PROGRESS, _END)
            self.queue.remove(sequence)

    async def _to_its_end(self, sequence: QueuedSequence, run: WozRun) -> None:
        self._commands[run.id] = sequence
        if run.id in self._early:
            self._began(sequence)
        try:
            await run
        except asyncio.CancelledError:
            with contextlib.suppress(WozError):
                await run.cancel()
            raise
        finally:
            self._commands.pop(run.id, None)

    def _began(self, sequence: QueuedSequence) -> None:
        if self._playing is not sequence:
            self._playing = sequence
            self.idle.clear()
            self._tell(sequence.id, _PROGRESS, _START)

    async def _end(self, moment: float) -> None:
        try:
            await asyncio.sleep(max(0.0, moment - self._client.now()))
        finally:
            self._moments.remove(moment)
        if self._playing is not None:
            self._tasks[self._playing].cancel()
