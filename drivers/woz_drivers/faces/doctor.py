"""What `woz doctor` finds out about faces: the camera, the program that finds them, one look."""

from __future__ import annotations

import asyncio

from woz_drivers.camera.doctor import examine_pictures
from woz_drivers.faces.face_lines import FacesLine, RecogniserAnswer, decoded_line
from woz_drivers.faces.face_tracks import distance_of
from woz_drivers.faces.settings import FacesSettings
from woz_drivers.programs import child_process
from woz_drivers.programs.resident_program import ResidentProgram
from woz_tui.drivers.contract import DriverError, Finding, Probe

#: What the program is called in sentences, and what to do about it.
FINDER = "the program that finds faces"
REMEDY = "`woz doctor` says what it lacks; docs/how-to/faces.md sets it up"
_HELP = "docs/how-to/faces.md sets it up"
#: The picture is looked at so often: the first time takes longer. Until then it may take so long,
#: in seconds, and recognising faces at least so long; `woz doctor` waits for 15.
_LOOKS, _PATIENCE_S, _LEAST_S = 4, 12.0, 1.5


async def examine(probe: Probe) -> list[Finding]:
    """Who is in the first picture and how long that takes, or what is missing. Never raises."""
    loop = asyncio.get_running_loop()
    until = loop.time() + _PATIENCE_S
    faces = await _examine_faces(probe)  # by itself: it is timed
    if not probe.settings.identity:
        return faces
    return [*faces, await _examine_identity(probe, max(_LEAST_S, until - loop.time()))]


async def _examine_identity(probe: Probe, patience_s: float) -> Finding:
    """Whether the program that recognises faces works, and how many it has kept."""
    program = ResidentProgram(probe.settings.recogniser_words, probe.folder)
    try:
        if await program.load(patience_s) is None:
            raise DriverError(f"{program.program} has not loaded within {patience_s:.0f} s", _HELP)
        answer = await program.ask({"do": "list"}, RecogniserAnswer, _LEAST_S)
        if answer.refused:
            raise DriverError(answer.refused, answer.remedy)
    except DriverError as error:
        return Finding("error", probe.name, f"nobody is recognised: {error.what}", _HELP)
    finally:
        await program.close()
    count = len(answer.names)
    kept = "no face is" if not count else "1 face is" if count == 1 else f"{count} faces are"
    return Finding("ok", probe.name, f"{kept} kept: `woz visitors` lists them")


async def _examine_faces(probe: Probe) -> list[Finding]:

    async def describe(first: bytes) -> Finding:
        return await _look(probe, first)

    settings: FacesSettings = probe.settings
    if not settings.camera:
        return [await examine_pictures(probe, describe)]
    try:
        found = await _answer(settings, probe, bytes(settings.layout.size))
    except DriverError as error:
        return [Finding("error", probe.name, error.what, error.remedy)]
    text = f"a black picture took {found.ms:.0f} ms; those of {settings.camera} come in a session"
    return [Finding("ok", probe.name, text)]


async def _look(probe: Probe, picture: bytes) -> Finding:
    settings: FacesSettings = probe.settings
    found = await _answer(settings, probe, picture)
    text = f"{settings.source}: {settings.shape}; {_described(settings, found)}"
    limit = 1000 / min(settings.publish, settings.rate)
    if found.ms > limit:
        return Finding(
            "warning",
            probe.name,
            f"{text}: slower than {1000 / limit:g} pictures a second",
            "set `far: false`, or lower `closely`",
        )
    if not found.faces:
        return Finding("info", probe.name, text, "let somebody look at the camera, to try it")
    return Finding("ok", probe.name, text)


def _described(settings: FacesSettings, found: FacesLine) -> str:
    count = len(found.faces)
    words = "nobody" if not count else f"{count} face" if count == 1 else f"{count} faces"
    if count:
        nearest = min(distance_of(face, settings.focal) for face in found.faces)
        words += f", the nearest at {nearest * settings.distance_factor:.1f} m"
    return f"{words}, found in {found.ms:.0f} ms"


async def _answer(settings: FacesSettings, probe: Probe, picture: bytes) -> FacesLine:
    """The last answer to a picture that is shown a few times. Raises `DriverError`."""
    answers = bytearray()
    enough = asyncio.Event()

    def received(data: bytes) -> None:
        answers.extend(data)
        if answers.count(b"\n") >= _LOOKS:
            enough.set()

    running = await child_process.start(
        settings.finder_words, probe.folder, on_output=received, keeps_reading=True
    )
    try:
        running.write(picture * _LOOKS)
        status = await running.wait_or(enough, _PATIENCE_S)
        if status is not None:
            raise DriverError(f"{FINDER} ended: {running.reason(status)}", _HELP)
    finally:
        await running.end()
    try:
        return decoded_line(bytes(answers).splitlines()[-1])
    except (ValueError, IndexError):
        raise DriverError(f"{FINDER} gives no answer that can be read", _HELP) from None
