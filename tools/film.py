"""Draws animated pictures of the console and its robots: `python -m tools.film [folder]`.

Sessions are played in virtual time; what the console's body pane or its whole screen would show is
drawn six times a second from the very same cells: dots as dots, half blocks as lights, text as
text. Each film is one SVG without scripts that plays wherever images do, and always the same.
"""

from __future__ import annotations

import asyncio
import itertools
import re
import sys
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path

from rich.segment import Segment

from tests.console.piloting import piloted_console, screen_strips
from tools import IMAGES
from tools.demo_session import INTERVIEW, TALKING, WARM, Step, demo, play, space, welcome
from woz_tui.console.bodies.pane import pane_rows
from woz_tui.console.drawing.cells import Row
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.drawing.theme import DARK
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.protocol.messages import Message
from woz_tui.protocol.requests import Welcome
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session

#: A cell in the picture's units, and what is left free around them.
WIDE, HIGH, EDGE = 8, 16, 12
#: Cells of the pane, as on a roomy screen.
COLUMNS, LINES = 50, 19
RATE = 6.0
_BRAILLE = 0x2800
_DOTS = ((0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (0, 3), (1, 3))
#: Looks that are colours: of signs and of the ground beneath them.
_INK, _GROUND = re.compile("x[0-9a-f]{6}").fullmatch, re.compile("y[0-9a-f]{6}").fullmatch
_LIGHTS = {"▀": (0,), "▄": (1,), "█": (0, 1)}


@dataclass(frozen=True)
class Film:
    """A film: which experiment, what the wizard does, from when to when it is shown (seconds)."""

    name: str
    experiment: str
    steps: tuple[Step, ...]
    begin: float
    end: float
    title: str
    columns: int = COLUMNS
    lines: int = LINES
    #: The whole screen, and which keys the wizard presses there (what they do is among the steps);
    #: without any, it shows the body pane alone.
    keys: tuple[tuple[float, str], ...] = ()
    who: SessionIdentity = WARM


#: When the wizard presses space in the show.
_SCENES = (1.0, 4.0, 10.0, 15.5, 21.0, 24.0, 33.0, 40.5)
FILMS = (
    Film("demo", "eyepi", ((1.0, play("Demo")),), 10.0, 58.0, "EyePi's demonstration"),
    Film(
        "show",
        "show",
        tuple((at, space) for at in _SCENES),
        6.0,
        40.0,
        "Two robots in a show: the happy one dances and breaks down, the grumpy one is sad",
    ),
    Film(
        "answer",
        "interview",
        INTERVIEW,
        21.0,
        35.0,
        "The participant asks something; one key answers, and the next line goes on",
        80,
        24,
        ((27.5, "["), (32.0, "space")),
        TALKING,
    ),
)


@dataclass
class Reel:
    """What a console heard: the welcome at the beginning, then every message."""

    first: list[Welcome] = field(default_factory=list)
    messages: list[Message] = field(default_factory=list)

    def watch(self, session: Session) -> None:
        """Attach, as a console does."""
        self.first.append(welcome(session))
        session.hub.listen(self.messages.append)

    def moments(self, film: Film) -> Iterator[tuple[int, list[Message]]]:
        """Each of the film's moments (microseconds), and what was heard since the one before."""
        heard = deque(self.messages)
        for number in range(round((film.end - film.begin) * RATE)):
            now = round((film.begin + number / RATE) * 1_000_000)
            batch = []
            while heard and heard[0].t <= now:
                batch.append(heard.popleft())
            yield now, batch


def frames(film: Film) -> Iterator[list[Row]]:
    """The pane's rows at each of the film's moments."""
    if film.keys:
        reel = _played(film)
        yield from asyncio.run(_screens(film, reel))
        return
    picture = ConsoleState()
    reel = _played(film)
    picture.apply(reel.first, 0)
    for now, batch in reel.moments(film):
        picture.apply(batch, now)
        yield pane_rows(picture, PaintFrame(film.columns, film.lines, now))


def _played(film: Film) -> Reel:
    reel = Reel()
    demo(film.steps, film.end + 0.5, film.experiment, reel.watch, film.who)
    return reel


async def _screens(film: Film, reel: Reel) -> list[list[Row]]:
    """The whole screen at each of the film's moments."""
    found: list[list[Row]] = []
    keys = deque(film.keys)
    async with piloted_console(*reel.first, size=(film.columns, film.lines)) as seat:
        for now, batch in reel.moments(film):
            seat.clock.advance(max(0.0, (now - seat.clock.now_us()) / 1_000_000))
            await seat.tell(*batch)
            while keys and keys[0][0] * 1_000_000 <= now:
                await seat.press(keys.popleft()[1])
            strips = screen_strips(seat.console.screen)
            found.append([_cells(strip) for strip in strips[: film.lines]])
    return found


def _cells(strip: Iterable[Segment]) -> Row:
    """A line of the screen; its looks are its colours."""
    plain = str(DARK.background).removeprefix("#").lower()
    cells: list[tuple[str, str]] = []
    for text, style, _ in strip:
        if style is None:
            cells.append((text, "plain"))
            continue
        ink = style.color.get_truecolor().hex[1:] if style.color is not None else "e6e9ed"
        ground = style.bgcolor.get_truecolor().hex[1:] if style.bgcolor is not None else plain
        look = f"x{ink}" + (" strong" if style.bold else "")
        cells.append((text, look + (f" y{ground}" if ground != plain else "")))
    return tuple(cells)


# -- drawing --------------------------------------------------------------------------------------


def colours() -> Mapping[str, str]:
    """Look -> colour on dark ground."""
    told = DARK.variables
    looks = {name.removeprefix("woz-"): colour for name, colour in told.items()}
    return {**looks, "plain": str(DARK.foreground), "stale": looks["muted"]}


def drawn(row: Row) -> str:
    """One row as SVG at the upper left, its dots and lights as one path for each look."""
    paths: dict[tuple[str, str], list[str]] = {}
    texts: list[str] = []
    column = 0
    for text, look in row:
        for begin, run in _runs(text):
            x = (column + begin) * WIDE
            if run[0] in _LIGHTS:
                paths.setdefault(("l", look), []).extend(_lights(run, x))
            elif ord(run[0]) >= _BRAILLE and ord(run[0]) < _BRAILLE + 256:
                paths.setdefault(("d", look), []).extend(_dots(run, x))
            elif run.strip():
                texts.append(_text(run, look, x))
        column += len(text)
    shapes = [
        f'<path class="{kind} {look}" d="{"".join(steps)}"/>'
        for (kind, look), steps in paths.items()
    ]
    return "".join(_ground(row) + shapes + texts)


def _runs(text: str) -> Iterator[tuple[int, str]]:
    """Stretches of one kind: lights, dots, or text in which no two blanks follow each other."""
    begin = 0
    for kind, group in itertools.groupby(text, _kind):
        run = "".join(group)
        if kind == "text":
            at = 0
            for part in run.split("  "):
                if part.strip():
                    yield begin + at + len(part) - len(part.lstrip()), part.strip()
                at += len(part) + 2
        else:
            yield begin, run
        begin += len(run)


def _kind(sign: str) -> str:
    if sign in _LIGHTS:
        return "lights"
    return "dots" if _BRAILLE <= ord(sign) < _BRAILLE + 256 else "text"


def _lights(run: str, x: int) -> list[str]:
    half = HIGH // 2
    steps = []
    for place, sign in enumerate(run):
        for part in _LIGHTS[sign]:
            steps.append(f"M{x + place * WIDE} {part * half}h{WIDE}v{half}h-{WIDE}z")
    return steps


def _dots(run: str, x: int) -> list[str]:
    steps = []
    for place, sign in enumerate(run):
        bits = ord(sign) - _BRAILLE
        for number, (across, down) in enumerate(_DOTS):
            if bits >> number & 1:
                left = x + place * WIDE + WIDE // 4 + across * WIDE // 2
                steps.append(f"M{left} {HIGH // 8 + down * HIGH // 4}h0")
    return steps


def _text(run: str, look: str, x: int) -> str:
    length = len(run) * WIDE
    return f'<text class="{look}" x="{x}" y="12" textLength="{length}">{escape(run)}</text>'


def _ground(row: Row) -> list[str]:
    """The dark ground of a face."""
    grounds, column = [], 0
    for text, look in row:
        ground = look.partition(" y")[2]
        if ground or look.startswith("face-"):
            size = f'width="{len(text) * WIDE}" height="{HIGH}"'
            paint = f"y{ground}" if ground else "g"
            grounds.append(f'<rect class="{paint}" x="{column * WIDE}" {size}/>')
        column += len(text)
    return grounds


def style(seconds: float, shown: Sequence[Sequence[Row]]) -> str:
    """The film's colours, and how each of its frames is seen at its time."""
    inks = {name for frame in shown for row in frame for _, look in row for name in look.split()}
    paint = [
        f".{look}{{fill:{colour};stroke:{colour}}}"
        for look, colour in colours().items()
        if "ground" not in look
    ]
    paint += [f".{ink}{{fill:#{ink[1:]};stroke:#{ink[1:]}}}" for ink in sorted(inks) if _INK(ink)]
    paint += [f"rect.{ink}{{fill:#{ink[1:]};stroke:none}}" for ink in sorted(inks) if _GROUND(ink)]
    share = 100.01 / len(shown)  # a moment more: a frame must not go before the next one is there
    return "".join(
        (
            "text{font:13px ui-monospace,Menlo,Consolas,DejaVu Sans Mono,monospace;",
            "stroke:none!important;white-space:pre}.strong,.title{font-weight:bold}",
            ".d{stroke-width:3;stroke-linecap:round;fill:none}.l{stroke:none!important}",
            f".g{{fill:{colours()['face-ground']}}}",
            *paint,
            f".f{{visibility:hidden;animation:s {seconds:g}s step-end infinite}}",
            f"@keyframes s{{0%{{visibility:visible}}{share:.4f}%,100%{{visibility:hidden}}}}",
            ".p{visibility:visible}",
            "@media(prefers-reduced-motion:reduce){.f{animation:none}}",
        )
    )


def svg(film: Film, shown: Sequence[Sequence[Row]]) -> str:
    """The whole film. Rows that never change are drawn once, all others wherever they are used."""
    seconds = len(shown) / RATE
    names: dict[str, str] = {}
    rows = [[drawn(row) for row in frame] for frame in shown]
    still = [y for y in range(film.lines) if len({frame[y] for frame in rows}) == 1]
    moments = []
    for number, frame in enumerate(rows):
        uses = "".join(
            f'<use href="#{names.setdefault(row, f"r{len(names)}")}" y="{y * HIGH}"/>'
            for y, row in enumerate(frame)
            if y not in still and row
        )
        delay = number / RATE - seconds if number else 0.0
        first = " p" if not number else ""
        moments.append(f'<g class="f{first}" style="animation-delay:{delay:.4f}s">{uses}</g>')
    defined = "".join(f'<g id="{name}">{row}</g>' for row, name in names.items())
    base = "".join(f'<g transform="translate(0 {y * HIGH})">{rows[0][y]}</g>' for y in still)
    width, height = film.columns * WIDE + 2 * EDGE, film.lines * HIGH + 2 * EDGE
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'width="{width}" height="{height}"><title>{escape(film.title)}</title>'
        f"<style>{style(seconds, shown)}</style><defs>{defined}</defs>"
        f'<rect width="{width}" height="{height}" rx="8" fill="{DARK.background}"/>'
        f'<g transform="translate({EDGE} {EDGE})">{base}{"".join(moments)}</g></svg>\n'
    )


def main() -> None:
    """Draw all films, or those named after the folder."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else IMAGES
    folder.mkdir(parents=True, exist_ok=True)
    wanted = set(sys.argv[2:])
    for film in FILMS:
        if not wanted or film.name in wanted:
            (folder / f"{film.name}.svg").write_text(svg(film, list(frames(film))), "utf-8")


if __name__ == "__main__":
    main()
