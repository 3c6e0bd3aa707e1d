"""ELAN annotation files, EAF 3.0: one tier a panel, engagement, speech, notes and so on.

The format is described in H. Sloetjes et al., "ELAN Annotation Format: EAF 3.0" (The Language
Archive, MPI Nijmegen); times are whole milliseconds.
"""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import PurePath
from urllib.parse import quote

from woz_tui import __version__
from woz_tui.export.event_model import ExportSession
from woz_tui.export.exporter import Exporter
from woz_tui.export.log_sources import LogSource
from woz_tui.export.tiers import Tier, TierSpan, tiers_of, unique_names, without_overlaps
from woz_tui.export.visitor_sound import write_sound
from woz_tui.system.text_cleaning import one_line, seconds, visible

#: ELAN shows nothing shorter: a frame of PAL video.
SHORTEST_MS = 40
_SCHEMA = "http://www.mpi.nl/tools/elan/EAFv3.0.xsd"
_XSI = "http://www.w3.org/2001/XMLSchema-instance"
_DECLARATION = '<?xml version="1.0" encoding="UTF-8"?>'
_TYPE = "session"
#: A document needs a date; this one says that there is none.
_NO_DATE = "1970-01-01T00:00:00Z"
#: Well within what a TIME_SLOT can hold (xsd:unsignedInt): 24 days.
_LATEST = 2**31
_MIME = {
    ".wav": "audio/x-wav",
    ".mp3": "audio/*",
    ".mp4": "video/mp4",
    ".m4v": "video/mp4",
    ".mov": "video/quicktime",
    ".mpg": "video/mpeg",
    ".mpeg": "video/mpeg",
}
_ABOUT = """## Files

One `.eaf` for each session: open it in ELAN. Where the visitor was recorded, a `.wav` of the same
name runs along with the session: silence where nobody was recorded.

Tiers: `trials`, `phases`, `breaks`, `engagement` (the state), `visitor speech` (as it was
understood), `robot speech` (from the moment when it began to speak), `panel ...` (the actions of
each panel, from the request to the end; the outcome in brackets unless it was done), `stops`,
`questionnaires`, `markers`, `notes`, `mistakes`, `cues`, `slots`, `proposals`,
`streams` (of and to a lab), `choices` (on a page), `dictation`, `pages` (in browsers),
`drivers`, `settings` (of the session), `settings that differ` (what a robot had, and what was
wanted), `conflicts` (of a robot's settings), and of each coder the tiers that they coded in a
replay, called after them. What overlaps is on a tier `...-2`. Nothing is shorter than 40 ms:
moments and shorter things were prolonged to that."""


class EafExporter(Exporter):
    """Writes one file for each session."""

    meaning = "ELAN"
    about = _ABOUT

    def add(self, session: ExportSession, source: LogSource) -> list[str]:
        """Writes one session, with its sound."""
        notes: list[str] = []
        media = self._media(session, notes)
        shift = min(0, self._options.offset)
        tiers = in_milliseconds(tiers_of(session), shift)
        if shift:
            notes.append(
                f"the session begins {seconds(-shift)} s before the medium: times are the medium's,"
                " and what ended before it began is left out"
            )
        root = document(session, tiers, media, notes)
        ET.indent(root)
        text = ET.tostring(root, encoding="unicode")
        self._folder.write(f"{session.name}.eaf", f"{_DECLARATION}\n{text}\n")
        return notes

    def _media(self, session: ExportSession, notes: list[str]) -> list[Medium]:
        media = []
        if self._options.media is not None:
            relative = os.path.relpath(self._options.media, self._folder.final)
            media.append(Medium(relative, max(0, self._options.offset)))
        if self._options.sound and self._options.offset < 0:
            notes.append("the visitor's sound is left out: ELAN cannot shift it to later")
        elif self._options.sound:
            name = f"{session.name}.wav"
            length, problems = write_sound(session, self._folder, name)
            notes += problems
            media += [Medium(name)] if length else []
        return media


@dataclass(frozen=True, slots=True)
class Medium:
    """A video or sound, as seen from the document's folder; `origin` microseconds of it lie before
    the session.
    """

    path: str
    origin: int = 0


def in_milliseconds(tiers: Iterable[Tier], shift: int = 0) -> list[Tier]:
    """The tiers in milliseconds, `shift` microseconds later, as ELAN can show them: no overlaps,
    nothing too short, nothing before 0.
    """
    result: list[Tier] = []
    for tier in tiers:
        spans = [_in_milliseconds(span, shift) for span in tier.spans if span.end + shift >= 0]
        result += without_overlaps(Tier(tier.name, tier.points, spans), SHORTEST_MS)
    return unique_names(result)


def _in_milliseconds(span: TierSpan, shift: int) -> TierSpan:
    def ms(us: int) -> int:
        return min(max(0, (us + shift + 500) // 1000), _LATEST)

    return TierSpan(ms(span.begin), ms(span.end), span.text)


def document(
    session: ExportSession, tiers: list[Tier], media: Iterable[Medium], notes: Iterable[str]
) -> ET.Element:
    started = session.started
    root = ET.Element(
        "ANNOTATION_DOCUMENT",
        {
            "AUTHOR": session.wizard or "woz-tui",
            "DATE": started.isoformat() if started else _NO_DATE,
            "FORMAT": "3.0",
            "VERSION": "3.0",
            f"{{{_XSI}}}noNamespaceSchemaLocation": _SCHEMA,
        },
    )
    _header(root, session, media, notes, sum(len(tier.spans) for tier in tiers))
    slots = _time_order(root, tiers)
    number = 0
    for tier in tiers:
        element = ET.SubElement(
            root, "TIER", {"LINGUISTIC_TYPE_REF": _TYPE, "TIER_ID": one_line(tier.name)}
        )
        for span in tier.spans:
            attributes = {
                "ANNOTATION_ID": f"a{number + 1}",
                "TIME_SLOT_REF1": slots[2 * number],
                "TIME_SLOT_REF2": slots[2 * number + 1],
            }
            annotation = ET.SubElement(element, "ANNOTATION")
            alignable = ET.SubElement(annotation, "ALIGNABLE_ANNOTATION", attributes)
            ET.SubElement(alignable, "ANNOTATION_VALUE").text = visible(span.text)
            number += 1
    ET.SubElement(
        root,
        "LINGUISTIC_TYPE",
        {"GRAPHIC_REFERENCES": "false", "LINGUISTIC_TYPE_ID": _TYPE, "TIME_ALIGNABLE": "true"},
    )
    return root


def _header(
    root: ET.Element,
    session: ExportSession,
    media: Iterable[Medium],
    notes: Iterable[str],
    count: int,
) -> None:
    header = ET.SubElement(root, "HEADER", {"MEDIA_FILE": "", "TIME_UNITS": "milliseconds"})
    for medium in media:
        # ELAN takes the relative one where there is no such file, and folders stay private.
        attributes = {
            "MEDIA_URL": f"file:///{quote(PurePath(medium.path).name)}",
            "MIME_TYPE": _MIME.get(PurePath(medium.path).suffix.lower(), "unknown"),
            "RELATIVE_MEDIA_URL": quote(f"./{medium.path}"),
        }
        if medium.origin:
            attributes["TIME_ORIGIN"] = str(medium.origin // 1000)
        ET.SubElement(header, "MEDIA_DESCRIPTOR", attributes)
    properties = [
        ("woz-tui", __version__),
        ("session", session.code),
        ("participants", " ".join(session.participants)),
        ("experiment", session.start.experiment if session.start else ""),
        *(("damage", each) for each in session.damage),
        *(("note", each) for each in notes),
        ("lastUsedAnnotationId", str(count)),
    ]
    for name, value in properties:
        ET.SubElement(header, "PROPERTY", {"NAME": name}).text = visible(value)


def _time_order(root: ET.Element, tiers: Iterable[Tier]) -> list[str]:
    """Slots by time; the ids of each span's two in turn. None is shared: moving an annotation in
    ELAN would move the other one along.
    """
    order = ET.SubElement(root, "TIME_ORDER")
    moments = [moment for tier in tiers for span in tier.spans for moment in (span.begin, span.end)]
    slots = [""] * len(moments)
    for number, place in enumerate(sorted(range(len(moments)), key=moments.__getitem__), start=1):
        slots[place] = f"ts{number}"
        attributes = {"TIME_SLOT_ID": slots[place], "TIME_VALUE": str(moments[place])}
        ET.SubElement(order, "TIME_SLOT", attributes)
    return slots
