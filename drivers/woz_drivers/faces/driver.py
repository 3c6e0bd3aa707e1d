"""Who is in front of a camera: how many, how far, where, who looks, and who is addressed."""

from __future__ import annotations

import asyncio
import statistics
from collections.abc import Iterable, Mapping
from typing import Any

from woz_drivers.camera.picture_feed import PictureFeed, PictureMark
from woz_drivers.faces import doctor
from woz_drivers.faces.face_identity import EACH_IDENTITY, IDENTITY, FaceIdentity
from woz_drivers.faces.face_lines import LONGEST, FacesLine, SeenFace, decoded_line
from woz_drivers.faces.face_tracks import (
    AddressedPerson,
    FaceTrack,
    FaceTracker,
    direction_of,
    distance_of,
    gaze_of,
    judge_gaze,
)
from woz_drivers.faces.feed_camera import FeedCamera
from woz_drivers.faces.settings import FacesSettings
from woz_drivers.programs.byte_stream import ByteStream, ChunkCutter, StreamCommand, StreamListener
from woz_tui.drivers.contract import (
    FACE_CONSENT,
    KEPT,
    LEARN_FACE,
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    DriverFacts,
    Finding,
    Health,
    Job,
    Offer,
    PassiveDriver,
    Probe,
    RejectedError,
    Verb,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.motion.body_feeds import SEEN, Sighting
from woz_tui.protocol.messages import AddressedChanged, Json

#: Of the person who is addressed, and of everybody: the text of these is the number of the face.
ADDRESSED = ("presence", "people", "addressed", "gaze", "distance", "direction")
EACH = ("gaze.face", "distance.face", "direction.face")
_CHECK = "try its command in a terminal; `woz doctor` shows its output"
#: A calibration needs so many pictures with a face, and waits for so many seconds longer for them.
_LEAST, _LATE_S = 5, 2.0
#: What is known of a face is told for so long: small ones are not found in every picture.
_FRESH_US = 150_000
#: Colours of frames: who is addressed, who looks, everybody else (Okabe and Ito, 2008).
_GREEN, _YELLOW, _GREY = (0, 158, 115), (240, 228, 66), (200, 200, 200)
NEXT, RULE = "next", "rule"


class Faces(PassiveDriver):
    """One camera, and a program beside the robot process that finds faces in its pictures.

    The newest picture is handed to the program when it has answered the one before. Readings are of
    the person who is addressed; those of each face have its number as text. The feed `seen` has the
    middle of the addressed face, for a body that follows it, and the feed `picture` the pictures
    with frames around the faces, while somebody watches. With `identity` a second program is asked
    whose faces they are.
    """

    Settings = FacesSettings
    summary = "faces in a camera's pictures: how many, how far, whether they look"
    facts = DriverFacts(
        needs="a camera, the extra `faces` and 6 MB of networks, which one command fetches",
        page="docs/how-to/faces.md",
        shown=("loss", "return"),
    )
    settings: FacesSettings

    def __init__(self, name: str, settings: FacesSettings, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self._neutral = (settings.neutral_yaw, settings.neutral_pitch)
        self._factor = settings.distance_factor
        self._seen = context.feed(SEEN)
        self._offer = PictureFeed(settings, context)
        self._tracker = FaceTracker(settings.hold)
        self._addressed = AddressedPerson()
        self._there: list[FaceTrack] = []
        self._addressed_shown = AddressedChanged()
        self._frame = 0
        #: When the next readings are due.
        self._due_us = 0
        self._sample: FaceSample | None = None
        self._camera: ByteStream | FeedCamera | None = None
        self._cutter = ChunkCutter(settings.layout.size, self._came)
        self._camera_trouble: DriverError | None = None
        #: The newest picture, and the one that the program has in work, with when each was taken.
        self._waiting: tuple[bytes, int] | None = None
        self._in_work: tuple[bytes, int] | None = None
        self._identity: FaceIdentity | None = None
        self._finder: ByteStream | None = None
        self._finder_trouble: DriverError | None = None
        self._line = b""

    @classmethod
    def people_data(cls, settings: Any) -> Iterable[tuple[str, str]]:
        yield KEPT, "where faces are and whether they look here, in the log; no pictures"
        if settings.identity:
            yield KEPT, "of people who have consented: features of their faces, in a store beside"
        else:
            yield KEPT, "nobody's face is recognised (identity: false)"

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """Readings of the person who is addressed and of each face; calibrations, and whom the
        robot addresses.
        """
        seconds = Argument("seconds", "seconds", "how long", default=2.0, range=Range(0.5, 30, "s"))
        metres = Argument(
            "metres", "number", "from the camera to the face", required=True, range=Range(0.2, 10)
        )
        who = Argument("who", "text", f"`{NEXT}`, `{RULE}` or a face's number", default=NEXT)
        return Offer(
            sensors=ADDRESSED + EACH + ((IDENTITY, EACH_IDENTITY) if settings.identity else ()),
            verbs=(
                Verb(
                    "calibrate_gaze",
                    "learn how it looks when somebody looks at the robot",
                    (seconds,),
                    lane="calibration",
                    limit_s=35.0,
                    evidence="measured",
                ),
                Verb(
                    "calibrate_distance",
                    "learn how wide a face is at a distance that was measured",
                    (metres, seconds),
                    lane="calibration",
                    limit_s=35.0,
                    evidence="measured",
                ),
                Verb(
                    *("address", "whose signs count", (who,)),
                    lane="addressed",
                    brief=True,
                    evidence="",
                ),
                *(_identity_verbs() if settings.identity else ()),
            ),
        )

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """Look at the camera's pictures for two seconds, and for faces in the first one."""
        return await doctor.examine(probe)

    async def open(self) -> None:
        """Start its programs, and again whenever one ends."""
        self.context.health(Health.CONNECTING, "starting the camera's command")
        settings, folder, clock = self.settings, self.context.folder, self.context.clock
        eye = StreamListener(self._camera_begun, self._received, self._stale, self._camera_lost)
        if settings.camera:
            size = (settings.width, settings.height)
            self._camera = FeedCamera(settings.camera, size, settings.rate, self.context, eye)
        else:
            command = StreamCommand(settings.words, folder, "nothing", _CHECK)
            self._camera = ByteStream(command, clock, eye)
        self._finder = ByteStream(
            StreamCommand(
                settings.finder_words,
                folder,
                "no answer",
                doctor.REMEDY,
                fed=True,
                name=doctor.FINDER,
            ),
            clock,
            StreamListener(
                self._finder_begun, self._answered, self._stale, self._finder_lost, self._ask
            ),
        )
        self._camera.start()
        self._finder.start()
        if settings.identity:
            self._identity = FaceIdentity(settings, self.context)
            self._identity.start()

    async def close(self) -> None:
        """End its programs."""
        programs = (self._camera, self._finder, self._identity)
        running = [one for one in programs if one is not None]
        self._camera = self._finder = self._identity = None
        await asyncio.gather(*(one.close() for one in running))

    # -- the camera ----------------------------------------------------------------------------

    def _camera_begun(self) -> None:
        self._cutter = ChunkCutter(self.settings.layout.size, self._came)

    def _received(self, data: bytes) -> None:
        self._cutter.feed(data)

    def _came(self, data: bytes) -> None:
        now_us = self.context.clock.now_us()
        self._camera_trouble = None
        self._waiting = (data, now_us)
        self._ask()
        self._offer.look_at(data, [self._mark(track) for track in self._there])

    def _camera_lost(self, trouble: DriverError) -> None:
        self._camera_trouble = trouble
        self._forget(trouble)

    # -- the program that finds faces ----------------------------------------------------------

    def _finder_begun(self) -> None:
        self._line, self._in_work = b"", None

    def _ask(self) -> None:
        """Hand over the newest picture, if the one before has been answered."""
        finder, waiting = self._finder, self._waiting
        if finder is None or not finder.running or waiting is None or self._in_work is not None:
            return
        self._in_work, self._waiting = waiting, None
        finder.write(waiting[0])

    def _answered(self, data: bytes) -> None:
        *lines, self._line = (self._line + data).split(b"\n")
        if len(self._line) > LONGEST:
            lines, self._line = [self._line], b""
        for line in lines:
            looked_at, self._in_work = self._in_work, None
            try:
                found = decoded_line(line)
            except ValueError as error:
                what = f"{doctor.FINDER} gives no answer that can be read: {error}"
                self._finder_lost(DriverError(what, doctor.REMEDY))
            else:
                if looked_at is not None:
                    self._look_at(found, *looked_at)
            self._ask()

    def _finder_lost(self, trouble: DriverError) -> None:
        self._finder_trouble = trouble
        self._forget(trouble)

    def _forget(self, trouble: DriverError) -> None:
        """Nobody knows who is there."""
        self._tracker.forget()
        self._there = []
        self._tell_addressed(None)
        if self._identity is not None:
            self._identity.forget_tracks()
        self._stale(trouble.what)
        if self._sample is not None and not self._sample.ended.done():
            self._sample.ended.set_exception(DeviceLostError(trouble.what, trouble.remedy))
        worst = self._camera_trouble or self._finder_trouble or trouble
        health = Health.LOST if self._camera_trouble is not None else Health.FAULTED
        self.context.health(health, worst.what, worst.remedy)

    def _stale(self, why: str) -> None:
        for sensor in (*ADDRESSED, *((IDENTITY,) if self._identity is not None else ())):
            self.context.sensor(sensor, "stale", why)

    # -- faces ---------------------------------------------------------------------------------

    def _look_at(self, found: FacesLine, data: bytes, taken_us: int) -> None:
        settings = self.settings
        self._finder_trouble = None
        there = self._tracker.update(found.faces, taken_us)
        for track in there:
            if track.seen_us == taken_us:
                judge_gaze(track, self._neutral, settings.gaze_within)
                track.distance = self._factor * distance_of(track.face, settings.focal)
                track.direction = direction_of(track.face, settings.width, settings.focal)
        self._there = there
        addressed = self._addressed.update(there, taken_us)
        self._tell_addressed(None if addressed is None else addressed.id)
        fresh = addressed is not None and addressed.seen_us == taken_us
        if self._sample is not None:
            self._sample.add(addressed.face if addressed is not None and fresh else None, taken_us)
        if self._identity is not None:
            self._identity.look_at(data, there, addressed, taken_us)
        self._frame += 1
        self._seen.put(self._sighting(addressed, taken_us))
        if self._camera_trouble is None:
            self.context.health(Health.CONNECTED, f"{settings.source}, {settings.shape}")
            for sensor in ADDRESSED:
                self.context.sensor(sensor, "ok")
            self._publish(addressed, taken_us)

    def _tell_addressed(self, face: int | None) -> None:
        """An event, but only on a change: readings may be left out of a log, and are not events."""
        by_hand = face is not None and self._addressed.by_hand
        changed = AddressedChanged(face=face, chosen="hand" if by_hand else "rule")
        if changed != self._addressed_shown:
            self._addressed_shown = changed
            self.context.show(changed)

    def _sighting(self, addressed: FaceTrack | None, taken_us: int) -> Sighting:
        if addressed is None:
            return Sighting(taken_us, self._frame, None, None)
        mark = self._mark(addressed)
        size = (mark.right - mark.left) * (mark.bottom - mark.top)
        x, y = mark.left + mark.right - 1, mark.top + mark.bottom - 1
        return Sighting(taken_us, self._frame, x, y, size)

    def _publish(self, addressed: FaceTrack | None, taken_us: int) -> None:
        """At most `publish` times a second."""
        if taken_us < self._due_us:
            return
        self._due_us = max(self._due_us + round(1_000_000 / self.settings.publish), taken_us)
        reading = self.context.reading
        reading("presence", float(bool(self._there)))
        reading("people", float(len(self._there)))
        if self._identity is not None:
            self._identity.publish(addressed)
        for track in self._there:
            if taken_us - track.seen_us <= _FRESH_US:
                self._publish_of(track, ".face", str(track.id))
        if addressed is None:
            reading("addressed", None)
            reading("gaze", 0.0)
            reading("distance", None, unit="m")
            reading("direction", None, unit="deg")
            return
        text = "by hand" if self._addressed.by_hand else ""
        reading("addressed", float(addressed.id), text=text)
        if taken_us - addressed.seen_us <= _FRESH_US:
            self._publish_of(addressed)

    def _publish_of(self, track: FaceTrack, kind: str = "", text: str = "") -> None:
        reading = self.context.reading
        looks = None if track.looks is None else float(track.looks)
        angle = None if track.angle is None else round(track.angle, 1)
        reading(f"gaze{kind}", looks, text=text, raw=angle)
        reading(f"distance{kind}", round(track.distance, 3), text=text, unit="m")
        reading(f"direction{kind}", round(track.direction, 1), text=text, unit="deg")

    def _mark(self, track: FaceTrack) -> PictureMark:
        face, width, height = track.face, self.settings.width, self.settings.height
        colour = _YELLOW if track.looks else _GREY
        return PictureMark(
            face.left / width,
            face.top / height,
            face.right / width,
            face.bottom / height,
            _GREEN if track.id == self._addressed.id else colour,
        )

    # -- verbs -----------------------------------------------------------------------------------

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Calibrate, or choose who is addressed."""
        match job.verb:
            case "calibrate_gaze":
                return await self._calibrate_gaze(job)
            case "calibrate_distance":
                return await self._calibrate_distance(job)
            case "address":
                return self._address(str(job.args["who"]).strip())
            case "learn_face" | "face_consent" if self._identity is not None:
                return await self._perform_identity(self._identity, job)
        raise RejectedError(f"a camera does not know {job.verb!r}")

    async def _perform_identity(self, identity: FaceIdentity, job: Job) -> Mapping[str, Json]:
        name = str(job.args["name"]).strip()
        if not name:
            raise RejectedError("a face needs a name", "give a code, such as V7")
        if job.verb == FACE_CONSENT:
            return await identity.consent(name, given=bool(job.args["given"]))
        there = [track for track in self._there if track.id == self._addressed.id]
        return await identity.learn(name, there[0] if there else None)

    async def _calibrate_gaze(self, job: Job) -> Mapping[str, Json]:
        gazes = [gaze for face in await self._faces(job) if (gaze := gaze_of(face)) is not None]
        if len(gazes) < _LEAST:
            raise DriverError("nobody's gaze was seen", "come nearer to the camera, look at it")
        yaw, pitch = (round(statistics.median(axis), 1) for axis in zip(*gazes, strict=True))
        self._neutral = (yaw, pitch)
        self._tell_settings(neutral_yaw=yaw, neutral_pitch=pitch)
        return {"neutral_yaw": yaw, "neutral_pitch": pitch, "pictures": len(gazes)}

    async def _calibrate_distance(self, job: Job) -> Mapping[str, Json]:
        metres = float(job.args["metres"])
        faces = await self._faces(job)
        if len(faces) < _LEAST:
            raise DriverError("nobody was seen", "let somebody look at the camera, and measure")
        measured = statistics.median(distance_of(face, self.settings.focal) for face in faces)
        self._factor = round(metres / measured, 3)
        self._tell_settings(distance_factor=self._factor)
        return {"distance_factor": self._factor, "pictures": len(faces)}

    def _tell_settings(self, **found: float) -> None:
        settings = ", ".join(f"{name}: {value}" for name, value in found.items())
        self.context.notice(
            "info", f"{self.name} is calibrated: {settings}", "write that into the robot file"
        )

    async def _faces(self, job: Job) -> list[SeenFace]:
        """The addressed face in the pictures of the seconds that the command names."""
        if self._camera_trouble is not None or self._finder_trouble is not None:
            raise DeviceLostError(f"{self.name} finds no faces at present", "see `woz doctor`")
        seconds = float(job.args["seconds"])
        job.expects(seconds)
        sample = self._sample = FaceSample(self.context.clock.now_us(), seconds)
        try:
            async with asyncio.timeout(seconds + _LATE_S):
                await sample.ended
        except TimeoutError:
            pass  # pictures have ended; what came until then may do
        finally:
            self._sample = None
        return sample.faces

    def _address(self, who: str) -> Mapping[str, Json]:
        there = [track.id for track in self._there]
        if who == RULE:
            self._addressed.choose(None)
            return {"addressed": RULE}
        wanted = self._addressed.next_of(self._there) if who == NEXT else _number(who)
        if wanted not in there:
            shown = ", ".join(map(str, there))
            raise RejectedError(
                f"there is no face {who}" if there else "nobody is there",
                f"there are {shown}" if there else "",
            )
        self._addressed.choose(wanted)
        return {"addressed": wanted}


def _identity_verbs() -> tuple[Verb, ...]:
    return (
        common_verb(FACE_CONSENT, lane="consent", limit_s=30.0, evidence="reported"),
        common_verb(
            LEARN_FACE,
            "recognise the addressed face by this name from now on, if they consented",
            lane="identity",
            limit_s=40.0,
            evidence="reported",
        ),
    )


def _number(text: str) -> int | None:
    return int(text) if text.isascii() and text.isdigit() else None


class FaceSample:
    """The addressed face in the pictures of some seconds. `ended` is done when they have passed."""

    def __init__(self, began_us: int, seconds: float) -> None:
        self.faces: list[SeenFace] = []
        self.ended: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._began_us, self._us = began_us, round(seconds * 1e6)

    def add(self, face: SeenFace | None, taken_us: int) -> None:
        """The next picture; None: the face is not in it."""
        after_us = taken_us - self._began_us
        if face is not None and after_us >= 0:
            self.faces.append(face)
        if after_us >= self._us and not self.ended.done():
            self.ended.set_result(None)
