"""A simulated Furhat: speaks the Realtime API (`ws://ROBOT:9000/v1/events`), one JSON object each.

Names and fields are those of the vendor's client (furhat-realtime-api 0.1.3), which works with it.
What that does not say is from programs of people with a robot: silence about a gesture without
`monitor`, `request.system.*`, `request.attend.nobody`, the fields of a user. Nobody documents what
an error looks like, and whether `request.face.reset` ends a gesture: both are assumed here.
"""

from __future__ import annotations

import asyncio
import base64
import io
import math
import random
import sys
import wave
from collections import deque
from collections.abc import Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import aiohttp
from aiohttp import web
from naoqi_simulator.robot_time import Activities, SimulatorTime
from naoqi_simulator.visitor import ANSWERS, REMARKS, SimulatedPerson, SimulatedVisitors

from robot_simulators.web_robot import WebRobot, run_as_program

Event = dict[str, Any]

PATH = "/v1/events"
#: How fast it speaks, and how long a voice takes before its first word, in seconds.
CHARACTERS_PER_S, GENERATION_S = 14.0, 0.05
#: Seconds of the robot from one message about users, sound or pictures to the next.
USERS_S, AUDIO_S, CAMERA_S = 0.1, 0.1, 0.2
#: Somebody looks away who looks at the robot so much.
LOOKS, LOOKS_AWAY = 0.95, 0.2
VOICES = (
    {"voice_id": "Matthew-Neural (en-US) - Amazon Polly", "name": "Matthew-Neural"}
    | {"language": "en-US", "gender": "MALE", "provider": "Amazon Polly"},
    {"voice_id": "Amy-Neural (en-GB) - Amazon Polly", "name": "Amy-Neural"}
    | {"language": "en-GB", "gender": "FEMALE", "provider": "Amazon Polly"},
    {"voice_id": "Vicki-Neural (de-DE) - Amazon Polly", "name": "Vicki-Neural"}
    | {"language": "de-DE", "gender": "FEMALE", "provider": "Amazon Polly"},
)
FACES = ("adult - Alex", "adult - Isabel", "adult - default", "child - Billy", "anime - Vice")
#: A gesture's name with its seconds at duration 1.
GESTURES: Mapping[str, float] = {
    **{"Smile": 1.0, "BigSmile": 1.0, "Wink": 0.8, "Thoughtful": 1.5, "Surprise": 1.0, "Oh": 0.8},
    **{"BrowFrown": 1.0, "BrowRaise": 0.8, "Blink": 0.4, "CloseEyes": 0.4, "OpenEyes": 0.4},
    **{"Nod": 1.0, "Shake": 1.2, "Roll": 1.6, "GazeAway": 1.2},
    **{"ExpressDisgust": 1.2, "ExpressSad": 1.2, "ExpressAnger": 1.2, "ExpressFear": 1.2},
}


@dataclass(eq=False)
class FurhatClientConnection:
    """One program that is connected."""

    socket: web.WebSocketResponse
    access: bool
    #: What it wants again and again: users, camera, audio.
    streams: dict[str, asyncio.Task[None]] = field(default_factory=dict)
    #: The `request.listen.start` that holds; None: it does not listen.
    listening: Event | None = None
    #: The one that holds again when the robot has ended speaking.
    paused: Event | None = None


@dataclass(eq=False)
class FurhatUtterance:
    """Something to be said or played. `seconds`: of a sound that is known as a whole. `received`:
    bytes of 16-bit samples that have come of one that is being sent, until it is `complete`.
    """

    client: FurhatClientConnection
    request: Event
    text: str
    seconds: float | None = None
    received: int = 0
    complete: bool = True
    more: asyncio.Event = field(default_factory=asyncio.Event)


class FurhatSimulator(WebRobot):
    """Use it as `async with FurhatSimulator() as robot: robot.address`.

    Attributes:
        key: What a client must authenticate with.
        person: Who stands before it where no visitors come.
        ignored: Requests of these types are taken and have no effect and no answer.
        gestures_end_early: Whether `request.face.reset` ends a gesture.
        attended: At whom or what it looks: nobody, location, or the id of a user.
        location: Where a location is: metres to its left, up, forward.
    """

    def __init__(
        self,
        time: SimulatorTime | None = None,
        visitors: SimulatedVisitors | None = None,
        *,
        key: str = "",
    ) -> None:
        super().__init__(time, visitors)
        self.key = key
        self.person: SimulatedPerson | None = None
        self.ignored: set[str] = set()
        self.gestures_end_early = True
        self.volume = 70
        self.voice: Mapping[str, str] = VOICES[0]
        self.face_id = FACES[0]
        self.face: dict[str, float] = {}
        self.led = "#000000"
        self.attended = "nobody"
        self.location = (0.0, 0.0, 1.0)
        self._target = "nobody"
        self._clients: list[FurhatClientConnection] = []
        self._tasks: set[asyncio.Task[Any]] = set()
        self._going = Activities(self.time)
        self._queue: deque[FurhatUtterance] = deque()
        self._speaking: asyncio.Task[None] | None = None

    @property
    def speaking(self) -> str:
        """What it says now; empty: nothing."""
        return self._queue[0].text if self._queue else ""

    @property
    def gesturing(self) -> list[str]:
        """The gestures that are under way."""
        return [one.about for one in self._going.of("gesture")]

    @property
    def listening(self) -> bool:
        """Whether it listens for anybody."""
        return any(client.listening for client in self._clients)

    def requests(self, kind: str) -> list[Event]:
        """The requests of one type so far, without their ids."""
        return [
            {name: value for name, value in call.items() if name not in ("type", "request_id")}
            for name, call in self.calls
            if name == kind
        ]

    async def send_raw(self, text: str) -> None:
        """Send everybody something that is perhaps no event."""
        for socket in tuple(self.sockets):
            await socket.send_str(text)

    # -- one client ----------------------------------------------------------------------------

    def routes(self) -> Sequence[web.AbstractRouteDef]:
        return (web.get(PATH, self._serve),)

    async def close(self) -> None:
        """Hang up, and forget what was going on."""
        await super().close()
        for task in list(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        self._queue.clear()
        self._speaking = None

    async def _serve(self, request: web.Request) -> web.StreamResponse:
        client: FurhatClientConnection | None = None
        try:
            async for socket, message in self.messages(request):
                if client is None:
                    client = FurhatClientConnection(socket, access=not self.key)
                    self._clients.append(client)
                elif message is not None:
                    await self._take(client, message)
        finally:
            if client is not None:
                self._clients.remove(client)
                for stream in client.streams.values():
                    stream.cancel()
        assert client is not None
        return client.socket

    async def _take(self, client: FurhatClientConnection, request: Any) -> None:
        kind = request.get("type") if isinstance(request, dict) else None
        if not isinstance(kind, str):
            await self._answer(client, {}, "response.error", error="no class discriminator")
            return
        self.calls.append((kind, request))
        refusal = self.faults.refused.get(kind)
        if kind in self.ignored:
            return
        if refusal is not None:
            await self._answer(client, request, "response.error", error=refusal)
        elif kind == "request.auth":
            await self._authenticate(client, request)
        elif kind not in REQUESTS:
            await self._answer(client, request, "response.error", error=f"unknown event {kind}")
        elif not client.access:
            await self._answer(client, request, "response.error", error="Access denied")
        else:
            method = getattr(self, "_" + kind.removeprefix("request.").replace(".", "_"))
            await method(client, request)

    async def _authenticate(self, client: FurhatClientConnection, request: Event) -> None:
        if "key" in request:
            client.access = request["key"] == self.key or not self.key
        given: Event = {"access": client.access}
        if client.access:
            given["scope"] = "local_network"
        await self._answer(client, request, "response.auth", **given)

    async def _answer(
        self, client: FurhatClientConnection, request: Event, kind: str, **fields: Any
    ) -> None:
        """An event about a request carries the request's id, if it had one."""
        event = {"type": kind, **fields}
        if "request_id" in request:
            event["request_id"] = request["request_id"]
        await self.tell(client.socket, event)

    def _start(self, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    async def _pass(self, seconds: float) -> None:
        """Let so much of the robot's time pass, and more if it is frozen."""
        await self.time.sleep(seconds)
        await self._awake.wait()

    # -- speech --------------------------------------------------------------------------------

    async def _speak_text(self, client: FurhatClientConnection, request: Event) -> None:
        await self._enqueue(FurhatUtterance(client, request, str(request.get("text", ""))))

    async def _speak_audio(self, client: FurhatClientConnection, request: Event) -> None:
        self._start(self._fetch(client, request))

    async def _fetch(self, client: FurhatClientConnection, request: Event) -> None:
        try:
            async with (
                aiohttp.ClientSession(timeout=aiohttp.ClientTimeout(total=5)) as session,
                session.get(str(request.get("url"))) as answer,
            ):
                answer.raise_for_status()
                sound = await answer.read()
            with wave.open(io.BytesIO(sound)) as found:
                seconds = found.getnframes() / found.getframerate()
        except (aiohttp.ClientError, TimeoutError, wave.Error, EOFError, ValueError):
            await self._answer(
                *(client, request, "response.speak.end"), text="AUDIO", aborted=False, failed=True
            )
            return
        text = str(request.get("text", "AUDIO"))
        await self._enqueue(FurhatUtterance(client, request, text, seconds=seconds))

    async def _speak_audio_start(self, client: FurhatClientConnection, request: Event) -> None:
        await self._enqueue(FurhatUtterance(client, request, "AUDIO", complete=False))

    async def _speak_audio_data(self, client: FurhatClientConnection, request: Event) -> None:
        for one in self._sent_sounds(client):
            one.received += len(base64.b64decode(request.get("audio", "")))
            one.more.set()

    async def _speak_audio_end(self, client: FurhatClientConnection, _: Event) -> None:
        for one in self._sent_sounds(client):
            one.complete = True
            one.more.set()

    def _sent_sounds(self, client: FurhatClientConnection) -> list[FurhatUtterance]:
        return [one for one in self._queue if one.client is client and not one.complete][:1]

    async def _speak_stop(self, client: FurhatClientConnection, request: Event) -> None:
        await self._hush()

    async def _enqueue(self, utterance: FurhatUtterance) -> None:
        if utterance.request.get("abort"):
            await self._hush()
        self._queue.append(utterance)
        if self._speaking is None:
            self._speaking = self._start(self._voice())

    async def _hush(self) -> None:
        speaking, self._speaking = self._speaking, None
        aborted = list(self._queue)
        self._queue.clear()
        if speaking is not None:
            speaking.cancel()
            await asyncio.wait([speaking])
        for one in aborted:
            await self._ended(one, aborted=True)
        if aborted:
            await self._resume_listening()

    async def _voice(self) -> None:
        await self._pause_listening()
        while self._queue:
            await self._utter(self._queue[0])
            await self._ended(self._queue.popleft(), aborted=False)
        self._speaking = None
        await self._resume_listening()

    async def _ended(self, one: FurhatUtterance, *, aborted: bool) -> None:
        await self._answer(
            *(one.client, one.request, "response.speak.end"),
            text=one.text,
            aborted=aborted,
            failed=False,
        )

    async def _utter(self, one: FurhatUtterance) -> None:
        about = (one.client, one.request)
        await self._pass(GENERATION_S)
        await self._answer(
            *about, "response.speak.start", text=one.text, gen_time=round(GENERATION_S * 1000)
        )
        if one.request["type"] == "request.speak.audio.start":
            await self._play(one)
        elif one.seconds is not None:
            await self._pass(one.seconds)
        else:
            for index, word in enumerate(one.text.split()):
                if one.request.get("monitor_words"):
                    await self._answer(*about, "response.speak.word", word=word, index=index)
                await self._pass((len(word) + 1) / CHARACTERS_PER_S)

    async def _play(self, one: FurhatUtterance) -> None:
        """Sound that is sent piece by piece: it ends when all of it was played."""
        rate = int(one.request.get("sample_rate", 24000))
        played = 0
        while played < one.received or not one.complete:
            if played >= one.received:
                one.more.clear()
                await one.more.wait()
                continue
            piece = min(one.received - played, rate // 2)
            await self._pass(piece / 2 / rate)
            played += piece
            await self._answer(
                *(one.client, one.request, "response.speak.audio.buffer"),
                played=played,
                received=one.received,
            )

    # -- hearing -------------------------------------------------------------------------------

    async def _listen_config(self, client: FurhatClientConnection, request: Event) -> None:
        """To be seen in `calls`."""

    async def _listen_start(self, client: FurhatClientConnection, request: Event) -> None:
        client.listening, client.paused = request, None
        await self._answer(client, request, "response.listen.start")

    async def _listen_stop(self, client: FurhatClientConnection, request: Event) -> None:
        client.paused = None
        await self._no_longer(client, "stopped")

    async def _no_longer(self, client: FurhatClientConnection, cause: str) -> None:
        listening, client.listening = client.listening, None
        if listening is not None:
            await self._answer(client, listening, "response.listen.end", cause=cause)

    async def _pause_listening(self) -> None:
        for client in list(self._clients):
            wish = client.listening
            if wish is not None and wish.get("stop_robot_start", True):
                client.paused = wish if wish.get("resume_robot_end") else None
                await self._no_longer(client, "robot_speak")

    async def _resume_listening(self) -> None:
        for client in list(self._clients):
            if client.paused is not None:
                await self._listen_start(client, client.paused)

    async def hear(self, text: str) -> None:
        """Somebody says something; whoever listens is told as it is said."""
        heard = [client for client in self._clients if client.listening is not None]
        for client in heard:
            await self._answer(client, client.listening or {}, "response.hear.start")
        words = text.split()
        for count, word in enumerate(words, 1):
            await self._pass((len(word) + 1) / CHARACTERS_PER_S)
            for client in heard:
                wish = client.listening
                if wish is not None and wish.get("partial"):
                    so_far = " ".join(words[:count])
                    await self._answer(client, wish, "response.hear.partial", text=so_far)
        for client in heard:
            wish = client.listening
            if wish is not None:
                await self._pass(float(wish.get("end_speech_timeout", 1.0)))
                await self._answer(client, wish, "response.hear.end", text=text)
                if wish.get("stop_user_end", True):
                    await self._no_longer(client, "speech_end")

    # -- gestures and face ---------------------------------------------------------------------

    async def _gesture_start(self, client: FurhatClientConnection, request: Event) -> None:
        name = str(request.get("name"))
        if name in GESTURES:
            if request.get("monitor"):
                await self._answer(client, request, "response.gesture.start")
            self._start(self._gesture(client, request, name))

    async def _gesture(self, client: FurhatClientConnection, request: Event, name: str) -> None:
        seconds = GESTURES[name] * float(request.get("duration", 1.0))
        await self._going.last("gesture", seconds, name)
        if request.get("monitor"):
            await self._answer(client, request, "response.gesture.end")

    async def _face_params(self, client: FurhatClientConnection, request: Event) -> None:
        self.face.update(request.get("params", {}))

    async def _face_reset(self, client: FurhatClientConnection, request: Event) -> None:
        self.face.clear()
        if self.gestures_end_early:
            self._going.end("gesture")

    async def _face_headpose(self, client: FurhatClientConnection, request: Event) -> None:
        """To be seen in `calls`."""

    async def _face_config(self, client: FurhatClientConnection, request: Event) -> None:
        if request.get("face_id") in FACES:
            self.face_id = request["face_id"]

    async def _face_status(self, client: FurhatClientConnection, request: Event) -> None:
        given = {"face_id": self.face_id, "face_list": list(FACES)}
        wanted = {name: value for name, value in given.items() if request.get(name, True)}
        await self._answer(client, request, "response.face.status", **wanted)

    async def _led_set(self, client: FurhatClientConnection, request: Event) -> None:
        self.led = str(request.get("color", self.led))

    async def _led_set_individual(self, client: FurhatClientConnection, request: Event) -> None:
        """To be seen in `calls`."""

    # -- voice and volume ----------------------------------------------------------------------

    async def _voice_config(self, client: FurhatClientConnection, request: Event) -> None:
        wish = {
            name: str(value).lower()
            for name, value in request.items()
            if name in ("voice_id", "name", "gender", "language", "provider")
        }
        for voice in VOICES:
            if all(value in voice[name].lower() for name, value in wish.items()):
                self.voice = voice
                break
        await self._voice_status(client, request)

    async def _voice_status(self, client: FurhatClientConnection, request: Event) -> None:
        given = {"voice_id": self.voice["voice_id"], "voice_list": [dict(one) for one in VOICES]}
        wanted = {name: value for name, value in given.items() if request.get(name, True)}
        await self._answer(client, request, "response.voice.status", **wanted)

    async def _system_status(self, client: FurhatClientConnection, request: Event) -> None:
        await self._answer(
            client, request, "response.system.status", volume=self.volume, virtual=True
        )

    async def _system_config(self, client: FurhatClientConnection, request: Event) -> None:
        self.volume = int(request.get("volume", self.volume))

    # -- attention and users -------------------------------------------------------------------

    @property
    def user(self) -> SimulatedPerson | None:
        """Who is there now."""
        return self.person if self.visitors is None else self.visitors.at(self.time.now())

    async def _attend_user(self, client: FurhatClientConnection, request: Event) -> None:
        await self._attend(client, request, str(request.get("user_id", "closest")))

    async def _attend_location(self, client: FurhatClientConnection, request: Event) -> None:
        self.location = (float(request["x"]), float(request["y"]), float(request["z"]))
        await self._attend(client, request, "location")

    async def _attend_nobody(self, client: FurhatClientConnection, request: Event) -> None:
        await self._attend(client, request, "nobody")

    async def _attend(self, client: FurhatClientConnection, request: Event, target: str) -> None:
        self._target = self.attended = target
        self._find_user()
        await self._answer(
            client, request, "response.attend.status", target=target, current=self.attended
        )

    def _find_user(self) -> None:
        """Look at the one who is closest, if that is wanted."""
        if self._target == "closest":
            self.attended = "nobody" if self.user is None else f"user-{self.user.number}"

    async def _users_once(self, client: FurhatClientConnection, request: Event) -> None:
        self._find_user()
        user = self.user
        users = [] if user is None else [_seen(user, self.attended)]
        await self._answer(client, request, "response.users.data", users=users)

    async def _users_start(self, client: FurhatClientConnection, request: Event) -> None:
        self._stream(client, "users", self._repeat(self._users_once, client, USERS_S))

    async def _users_stop(self, client: FurhatClientConnection, request: Event) -> None:
        self._stream(client, "users", None)

    async def live(self) -> None:
        """Visitors speak by themselves."""
        draw = random.Random(self.address)
        talked = False
        while self.visitors is not None:
            user = self.user
            talks = user is not None and user.talking
            if talks and not talked:
                self._start(self.hear(draw.choice(REMARKS + ANSWERS)))
            talked = talks
            await self._pass(0.2)

    # -- sound and pictures --------------------------------------------------------------------

    async def _audio_start(self, client: FurhatClientConnection, request: Event) -> None:
        rate = int(request.get("sample_rate", 16000))
        self._stream(client, "audio", self._repeat(self._audio(rate), client, AUDIO_S))

    async def _audio_stop(self, client: FurhatClientConnection, request: Event) -> None:
        self._stream(client, "audio", None)

    def _audio(self, rate: int) -> Callable[[FurhatClientConnection, Event], Any]:
        quiet, loud = _noise(rate, 30), _noise(rate, 3000)

        async def send(client: FurhatClientConnection, request: Event) -> None:
            user = self.user
            sound = loud if user is not None and user.talking else quiet
            await self._answer(client, request, "response.audio.data", microphone=sound)

        return send

    async def _camera_once(self, client: FurhatClientConnection, request: Event) -> None:
        await self._answer(client, request, "response.camera.data", image=PICTURE)

    async def _camera_start(self, client: FurhatClientConnection, request: Event) -> None:
        self._stream(client, "camera", self._repeat(self._camera_once, client, CAMERA_S))

    async def _camera_stop(self, client: FurhatClientConnection, request: Event) -> None:
        self._stream(client, "camera", None)

    async def _repeat(
        self,
        send: Callable[[FurhatClientConnection, Event], Any],
        client: FurhatClientConnection,
        seconds: float,
    ) -> None:
        while True:
            await send(client, {})
            await self._pass(seconds)

    def _stream(
        self,
        client: FurhatClientConnection,
        name: str,
        work: Coroutine[Any, Any, None] | None,
    ) -> None:
        old = client.streams.pop(name, None)
        if old is not None:
            old.cancel()
        if work is not None:
            client.streams[name] = self._start(work)


def _seen(user: SimulatedPerson, attended: str) -> Event:
    """As `response.users.data` has somebody."""
    x, z = user.distance * math.sin(user.angle), user.distance * math.cos(user.angle)
    number = f"user-{user.number}"
    return {
        "id": number,
        **{"x": round(x, 3), "y": 0.0, "z": round(z, 3), "distance": round(user.distance, 3)},
        "attending": LOOKS if user.looking else LOOKS_AWAY,
        "attended": attended == number,
        "camera": {"x": round(60 - 60 * user.angle), "y": 25, "w": 40, "h": 45},
    }


def _noise(rate: int, loudest: int) -> str:
    """A tenth of a second of 16-bit sound in base64."""
    draw = random.Random(loudest)
    samples = (draw.randint(-loudest, loudest) for _ in range(rate // 10))
    return base64.b64encode(
        b"".join(one.to_bytes(2, "little", signed=True) for one in samples)
    ).decode()


REQUESTS = frozenset(
    f"request.{name}"
    for name in (
        *("speak.text", "speak.audio", "speak.audio.start", "speak.audio.data"),
        *("speak.audio.end", "speak.stop", "listen.config", "listen.start", "listen.stop"),
        *("voice.status", "voice.config", "system.status", "system.config"),
        *("gesture.start", "face.params", "face.status", "face.config", "face.reset"),
        *("face.headpose", "led.set", "led.set.individual"),
        *("attend.user", "attend.location", "attend.nobody"),
        *("users.start", "users.stop", "users.once", "camera.start", "camera.stop"),
        *("camera.once", "audio.start", "audio.stop"),
    )
)


#: What its camera sees, as JPEG (160 x 120) in base64.
PICTURE = (
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDACgcHiMeGSgjISMtKygwPGRBPDc3PHtYXUlkkYCZlo+AjIqgtObDoKrarYqM"
    "yP/L2u71////m8H////6/+b9//j/2wBDASstLTw1PHZBQXb4pYyl+Pj4+Pj4+Pj4+Pj4+Pj4+Pj4+Pj4+Pj4+Pj4+Pj4"
    "+Pj4+Pj4+Pj4+Pj4+Pj4+Pj4+Pj/wAARCAB4AKADASIAAhEBAxEB/8QAGQABAAMBAQAAAAAAAAAAAAAAAAEDBAIF/8QA"
    "JBABAAIBAwIHAQAAAAAAAAAAAAECAwQRMUFREhMhMkJhcZH/xAAXAQEBAQEAAAAAAAAAAAAAAAAAAQMC/8QAGREBAQAD"
    "AQAAAAAAAAAAAAAAAAECESEx/9oADAMBAAIRAxEAPwDCA6cgAAAAAAAAAAAAAAAAAAAAAAAAAAsw4bZr+GvpHWez0Mel"
    "w0+Pinvb1S5SLMbXlj1b6bDePWkR919GDUae2C3ek8STKUuNikBUAAAAAAAAAAAACImZ2iN5kW6WsW1NInvv/Aejgxxi"
    "xVp16/qwGLYRekXpNbcTGyQHjXpNLzW3MTsho19YjUbx8oiZZ207GN5QAAAAAAAAAAABbpbRXU0me+39VETMTvE7TAPa"
    "FeDJGXFW/Xr+rGLYBF7xSk2txEbg87X2idRtHxiIlnTe83vNrczO6G05GN7QAAAAAAAAAAAExS0xvEJ8u3ZZj9kOk252"
    "5w2yYb+Ksbx1jflvrqccxvMzH1MMQ5vVmdjbOoxxHu3+tmLUZMme3G1I4jcCcLnap8u3ZE0tEb7L0W9s/i7TagB06AAA"
    "AWgM3YAAADqvCUV4SrK+gAgAATxITxIRwAjYAAAAAAAAAB1XhKK8JVlfQAQAAJ4kJ4kI4ARsAAAAAAAAAA6rwkFZX0AE"
    "AACeJAI4ARsAAAA//9k="
)


if __name__ == "__main__":
    sys.exit(run_as_program("furhat", FurhatSimulator))
