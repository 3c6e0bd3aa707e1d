"""The visitor's recorded sentences as one file of sound that runs along with the session."""

from __future__ import annotations

import wave
from collections.abc import Iterator

from woz_tui.analysis.text_format import counted
from woz_tui.export.event_model import ExportSession, SoundClip
from woz_tui.export.output_folder import OutputFolder
from woz_tui.system.files import open_regular

#: A session's sound above this length in seconds is not written: a WAV file ends at 4 GiB.
_LONGEST = 12 * 3600
_BLOCK = 1 << 16


def write_sound(session: ExportSession, folder: OutputFolder, name: str) -> tuple[int, list[str]]:
    """Write all clips of `session` into the file `name`, each at its time, with silence between.

    Returns the file's length in microseconds (0: there was nothing to write) and what had to be
    left out, in sentences. The file has the format of the first clip; others are left out.
    """
    clips, problems = readable_clips(session)
    if not clips:
        return 0, problems
    shape = clips[0][1]
    rate, frame = shape.framerate, shape.nchannels * shape.sampwidth
    ends = (_frames(clip.begin, rate) + shape.nframes for clip, shape in clips)
    length = max(_frames(session.duration, rate), *ends)
    if length > _LONGEST * rate:
        return 0, [*problems, f"{session.name}: too long for a file of sound"]
    with folder.binary(name) as file, wave.open(file, "wb") as sound:
        sound.setnchannels(shape.nchannels)
        sound.setsampwidth(shape.sampwidth)
        sound.setframerate(rate)
        sound.setnframes(length)
        for block in _blocks(clips, rate, frame, length):
            sound.writeframesraw(block)
    return length * 1_000_000 // rate, problems


_Clips = list[tuple[SoundClip, "wave._wave_params"]]


def readable_clips(session: ExportSession) -> tuple[_Clips, list[str]]:
    """The session's clips that can be read, in their order, each with its shape; and what is left
    out of them, in sentences.
    """
    clips: _Clips = []
    problems = []
    if session.clips_missing:
        sentences = counted(session.clips_missing, "recorded sentence")
        problems.append(f"no file was found beside the log for {sentences} of the visitor")
    folders = [folder.resolve() for folder in session.folders]
    for clip in sorted(session.clips, key=lambda clip: clip.begin):
        if not any(clip.path.resolve().is_relative_to(folder) for folder in folders):
            problems.append(f"{clip.path} lies outside of the log's folder and is left out")
            continue
        try:
            with open_regular(clip.path) as clip_file, wave.open(clip_file) as file:
                shape = file.getparams()
        except (OSError, EOFError, wave.Error) as error:
            problems.append(f"{clip.path.name} cannot be read and is left out: {error}")
            continue
        if shape.sampwidth == 1:  # silence is not 0 there
            problems.append(f"{clip.path.name} has 8 bits a sample and is left out")
            continue
        if clips and shape[:3] != clips[0][1][:3]:
            problems.append(f"{clip.path.name} has another format than the first and is left out")
            continue
        clips.append((clip, shape))
    return clips, problems


def _frames(us: int, rate: int) -> int:
    return us * rate // 1_000_000


def _blocks(clips: _Clips, rate: int, frame: int, length: int) -> Iterator[bytes]:
    """Silence and clips in turn; where clips overlap, the earlier one is heard."""
    position = 0
    for clip, _ in clips:
        yield from _silence(max(0, _frames(clip.begin, rate) - position) * frame)
        position = max(position, _frames(clip.begin, rate))
        with wave.open(str(clip.path), "rb") as file:
            skipped = max(0, position - _frames(clip.begin, rate))
            file.setpos(min(skipped, file.getnframes()))
            sound = file.readframes(min(file.getnframes(), length - position))
        yield sound
        position += len(sound) // frame
    yield from _silence((length - position) * frame)


def _silence(size: int) -> Iterator[bytes]:
    while size > 0:
        yield bytes(min(size, _BLOCK))
        size -= _BLOCK
