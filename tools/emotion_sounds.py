"""Tables of docs/how-to/emotion-sounds.md: cues with their sources, and what six sounds measure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from woz_drivers.sound import pcm_audio
from woz_drivers.sound.emotion_sound import cue_table, emotion_sound
from woz_drivers.sound.wav import Wav

from tools import replaced
from woz_tui.motion.emotions import DIRECTIONS, emotion_affect

#: What is measured: so long, with this seed, at full intensity.
SECONDS, SEED = 3.0, 7
#: A note ends where it is softer than this share of the loudest, over so many seconds.
_SOFT, _WINDOW_S = 0.12, 0.02


@dataclass(frozen=True, slots=True)
class SoundMeasures:
    """What of a sound can be measured without anybody who listens.

    `centroid`: mean frequency of its power spectrum, in Hz. `notes`: a second. `level`: RMS in dB
    of full scale. `rise`: semitones from the first note to the last, at their loudest frequencies.
    """

    centroid: float
    notes: float
    level: float
    rise: float


def measured(sound: Wav) -> SoundMeasures:
    """Measure samples alone, whatever they were made of."""
    samples = pcm_audio.decode(sound.data, sound.format, sound.channels)[:, 0].astype(np.float64)
    power = np.abs(np.fft.rfft(samples)) ** 2
    frequencies = np.fft.rfftfreq(samples.size, 1 / sound.rate)
    window = round(_WINDOW_S * sound.rate)
    pieces = samples[: samples.size // window * window].reshape(-1, window)
    loud = np.sqrt(np.mean(np.square(pieces), axis=1))
    sounding = np.concatenate(([False], loud > _SOFT * loud.max(), [False]))
    edges = np.flatnonzero(np.diff(sounding.astype(int)))
    notes = [samples[begin * window : end * window] for begin, end in edges.reshape(-1, 2)]
    pitches = [_loudest(note, sound.rate) for note in (notes[0], notes[-1])]
    return SoundMeasures(
        centroid=float((power * frequencies).sum() / power.sum()),
        notes=len(notes) / sound.seconds,
        level=float(20 * np.log10(np.sqrt(np.mean(np.square(samples))))),
        rise=float(12 * np.log2(pitches[1] / pitches[0])),
    )


def _loudest(note: np.ndarray[tuple[int], np.dtype[np.float64]], rate: int) -> float:
    padded = max(note.size, rate)  # to a Hertz
    spectrum = np.abs(np.fft.rfft(note * np.hanning(note.size), padded))
    return float(np.fft.rfftfreq(padded, 1 / rate)[int(np.argmax(spectrum))])


def measures() -> str:
    """A row for each emotion of the circle."""
    columns = ("emotion", "valence", "arousal", "centroid (Hz)", "notes a second")
    heading = " | ".join((*columns, "level (dB)", "rise (semitones)"))
    rows = [f"| {heading} |", "|---" * 7 + "|"]
    for emotion in DIRECTIONS:
        valence, arousal = emotion_affect(emotion, 1.0)
        seen = measured(emotion_sound(valence, arousal, SECONDS, SEED))
        place = f"{valence + 0.0:.2f} | {arousal + 0.0:.2f}"
        rows.append(
            f"| {emotion} | {place} | {seen.centroid:.0f} | {seen.notes:.1f} | {seen.level:.1f}"
            f" | {seen.rise:+.1f} |"
        )
    return "\n".join(rows).replace("-0.00", "0.00")


def cues() -> str:
    """The table of cues, and what its sources are."""
    table = cue_table()
    rows = ["| cue | what | by | at -1 | at 1 | unit | sources |", "|---|---|---|---|---|---|---|"]
    for cue in table.cues:
        by = f"{cue.by} x {cue.times}" if cue.times else cue.by
        scale = "" if cue.scale == "linear" else f" ({cue.scale})"
        low, high = (f"{value:g}" for value in (cue.low, cue.high))
        if cue.times:
            high = "0"
        rows.append(
            f"| `{cue.name}` | {cue.what} | {by}{scale} | {low} | {high} | {cue.unit}"
            f" | {', '.join(cue.sources)} |"
        )
    sources = [f"* **{name}**: {text}" for name, text in table.sources.items()]
    return "\n".join([*rows, "", *sources])


def refreshed(page: str) -> str:
    """The page with both."""
    return replaced(replaced(page, "cues", cues()), "measures", measures())
