"""Whose face each track is: asks the recognising program now and then, and has it learn faces.

A face is learnt only under a name for which the wizard has said, in this session and so in its log,
that its owner consents; one consent is good for one learning.
"""

from __future__ import annotations

import asyncio
import base64
import datetime
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from woz_drivers.faces.face_geometry import crop_of
from woz_drivers.faces.face_lines import RecogniserAnswer, SeenFace
from woz_drivers.faces.face_networks import PictureSampler
from woz_drivers.faces.face_tracks import FaceTrack
from woz_drivers.faces.settings import FacesSettings
from woz_drivers.programs.resident_program import ResidentProgram
from woz_tui.drivers.contract import DriverContext, DriverError, RejectedError
from woz_tui.drivers.face_store import FaceStore, default_path, key_of
from woz_tui.protocol.messages import Json
from woz_tui.system.tasks import end_tasks

#: Readings: of who is addressed, and of each face.
IDENTITY, EACH_IDENTITY = "identity", "identity.face"
#: Narrower faces are not asked about, or not learnt, in pixels.
_ASKED_FROM, _LEARNT_FROM = 28.0, 60.0
#: A name counts once it was the answer twice in a row; then it is asked for again after so long,
#: and for a stranger sooner at first, in microseconds.
_AGAIN_US, _STRANGER_US, _KNOWN_US = 200_000, 1_000_000, 5_000_000
#: So often a stranger is asked about sooner.
_SOON = 6
#: A face is learnt from so many pictures, which lie so far apart, in microseconds; each may keep
#: one waiting for so long, in seconds.
_PICTURES, _APART_US, _PATIENCE_S = 5, 200_000, 3.0
#: An answer may take so long, in seconds.
_ANSWER_S = 5.0
REMEDY = "`woz doctor` says what it lacks; docs/how-to/faces.md sets it up"


@dataclass(slots=True)
class TrackIdentity:
    """What is known of whose face a track is. `name`: None until it is known, empty for a stranger.
    `latest`: the last answer; `due_us`: when the next one is due.
    """

    name: str | None = None
    likeness: float = 0.0
    latest: str | None = None
    asked: int = 0
    due_us: int = 0

    def answered(self, name: str, likeness: float, now_us: int) -> bool:
        """Take an answer in; whether it changes the name."""
        agrees, self.latest = name == self.latest, name
        self.asked += 1
        if not agrees:
            self.due_us = now_us + _AGAIN_US
            return False
        changes, self.name, self.likeness = name != self.name, name, likeness
        soon = not name and self.asked <= _SOON
        self.due_us = now_us + (_STRANGER_US if soon else _KNOWN_US)
        return changes


@dataclass(slots=True)
class _Lesson:
    """A face that is being learnt: of this track the next picture from `from_us` on is wanted."""

    track: int
    from_us: int = 0
    picture: asyncio.Future[tuple[bytes, SeenFace]] = field(
        default_factory=lambda: asyncio.get_running_loop().create_future()
    )


class FaceIdentity:
    """Asks about one face at a time, so that finding faces is never held up."""

    def __init__(self, settings: FacesSettings, context: DriverContext) -> None:
        self._settings, self._context = settings, context
        self._program = ResidentProgram(
            settings.recogniser_words, context.folder, self._program_moved
        )
        self._ready = False
        self._trouble = ""
        self._tracks: dict[int, TrackIdentity] = {}
        self._asking: asyncio.Task[None] | None = None
        self._lesson: _Lesson | None = None
        #: Names, by their keys, for which there is a consent that was not used yet.
        self._consents: dict[str, str] = {}
        #: A face is written, or deleted: one at a time.
        self._storing = asyncio.Lock()

    def start(self) -> None:
        """Load the program."""
        self._program.start()

    async def close(self) -> None:
        """End it."""
        await end_tasks(self._asking)
        await self._program.close()

    def forget_tracks(self) -> None:
        """Nobody is there."""
        self._tracks.clear()

    def _program_moved(self, state: str, why: str, remedy: str) -> None:
        self._ready = state == "ready"
        if state == "lost":
            self._context.sensor(IDENTITY, "stale", why)
        if state == "lost" and why != self._trouble:
            self._context.notice("warning", f"nobody is recognised: {why}", REMEDY)
        self._trouble = why if state == "lost" else "" if self._ready else self._trouble

    # -- readings ----------------------------------------------------------------------------------

    def publish(self, addressed: FaceTrack | None) -> None:
        """Whose face the addressed one is, if that is known: the name is the text."""
        if not self._ready:
            return
        self._context.sensor(IDENTITY, "ok")
        known = TrackIdentity(name="") if addressed is None else self._tracks.get(addressed.id)
        if known is not None and known.name is not None:
            likeness = known.likeness if known.name else 0.0
            self._context.reading(IDENTITY, round(likeness, 2), text=known.name)

    def look_at(
        self, data: bytes, there: Sequence[FaceTrack], addressed: FaceTrack | None, now_us: int
    ) -> None:
        """Take the faces of a picture, and ask about one of them if one is due."""
        self._tracks = {one.id: self._tracks.get(one.id) or TrackIdentity() for one in there}
        seen = [one for one in there if one.seen_us == now_us and len(one.face.points) == 5]
        if self._lesson is not None:
            self._teach(self._lesson, data, seen, now_us)
            return
        if not self._ready or (self._asking is not None and not self._asking.done()):
            return
        due = [
            one
            for one in seen
            if one.face.width >= _ASKED_FROM and self._tracks[one.id].due_us <= now_us
        ]
        if due:
            first = min(due, key=lambda one: (one is not addressed, self._tracks[one.id].due_us))
            asking = self._identify(self._tracks[first.id], first.id, data, first.face)
            self._asking = asyncio.create_task(asking, name="identity of a face")

    async def _identify(
        self, known: TrackIdentity, number: int, data: bytes, face: SeenFace
    ) -> None:
        try:
            answer = await self._ask("identify", data, face)
        except DriverError:
            return  # the program's state says so already
        if known.answered(answer.name, answer.likeness, self._context.clock.now_us()):
            self._context.reading(EACH_IDENTITY, float(number), text=answer.name)

    async def _ask(
        self, do: str, data: bytes = b"", face: SeenFace | None = None, **what: Json
    ) -> RecogniserAnswer:
        """Raises `DriverError`: it did not answer, or refused."""
        if face is not None:
            crop = await asyncio.to_thread(self._crop, data, face)
            what["crop"] = base64.b64encode(crop).decode()
        answer = await self._program.ask({"do": do, **what}, RecogniserAnswer, _ANSWER_S)
        if answer.refused:
            raise DriverError(answer.refused, answer.remedy)
        return answer

    def _crop(self, data: bytes, face: SeenFace) -> bytes:
        settings = self._settings
        sampler = PictureSampler(settings.layout, mirrored=settings.mirror, flipped=settings.flip)
        sampler.load(data)
        return crop_of(sampler, face.points)

    # -- learning ----------------------------------------------------------------------------------

    async def consent(self, name: str, *, given: bool) -> Mapping[str, Json]:
        """The wizard has said whether the owner of this name consents. Raises `DriverError`: what
        is kept could not be deleted.
        """
        if given:
            self._consents[key_of(name)] = name
            return {"name": name, "given": True}
        self._consents.pop(key_of(name), None)
        async with self._storing:
            # Not by our program, which may not run: what is withdrawn must be deleted all the same.
            deleted = await asyncio.to_thread(FaceStore(default_path()).forget, [name])
            if self._settings.recogniser:  # it may have a store of its own
                deleted += (await self._ask("forget", names=[name])).names
        for known in self._tracks.values():
            if known.name and key_of(known.name) == key_of(name):
                known.name = known.latest = ""
        return {"name": name, "given": False, "deleted": bool(deleted)}

    async def learn(self, name: str, addressed: FaceTrack | None) -> Mapping[str, Json]:
        """Have the addressed face learnt. Raises `DriverError`, `RejectedError`."""
        if key_of(name) not in self._consents:
            raise RejectedError(
                f"nobody has said that {name} consents", f"ask them, then `face_consent: {name}`"
            )
        if addressed is None:
            raise DriverError("nobody is there", "let them look at the camera from one metre")
        try:
            for count in range(_PICTURES):
                data, face = await self._next_picture(addressed.id)
                await self._ask("take", data, face, anew=count == 0)
            log = self._context.media.name.removesuffix(".media")
            day = datetime.datetime.now(datetime.UTC).date().isoformat()
            async with self._storing:
                if key_of(name) not in self._consents:
                    raise RejectedError(f"{name} has withdrawn the consent: nothing was learnt")
                await self._ask("learn", name=name, consented=day, log=log)
        finally:
            self._lesson = None
        self._consents.pop(key_of(name), None)  # a withdrawal that waits will delete it
        self._tracks[addressed.id] = TrackIdentity()
        return {"name": name, "face": addressed.id, "pictures": _PICTURES}

    async def _next_picture(self, track: int) -> tuple[bytes, SeenFace]:
        before = self._lesson
        lesson = self._lesson = _Lesson(track, before.from_us if before is not None else 0)
        try:
            async with asyncio.timeout(_PATIENCE_S):
                return await lesson.picture
        except TimeoutError:
            raise DriverError(
                "the face was not seen well enough",
                "let them look at the camera from one metre in good light",
            ) from None

    def _teach(self, lesson: _Lesson, data: bytes, seen: Sequence[FaceTrack], now_us: int) -> None:
        for track in seen:
            good = track.id == lesson.track and track.face.width >= _LEARNT_FROM
            if good and now_us >= lesson.from_us and not lesson.picture.done():
                lesson.from_us = now_us + _APART_US
                lesson.picture.set_result((data, track.face))
