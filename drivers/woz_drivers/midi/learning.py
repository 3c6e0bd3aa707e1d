"""Learning a panel: which control shall do what is asked one by one, and heard from the panel.

The conversation itself is `woz midi learn`; here is what it is about. Nothing in here waits.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, fields, replace
from pathlib import Path

import yaml

from woz_drivers.midi import devices
from woz_drivers.midi.panel_layouts import LAYOUTS, MidiSignal
from woz_drivers.midi.panel_maps import ControlMapping, PanelMap
from woz_drivers.midi.resolved_map import controls_by_signal, mapped_controls
from woz_drivers.midi.settings import MidiSettings
from woz_drivers.midi.wire import BEND, CC, NOTE, PROGRAM, MidiDecoder, MidiMessage
from woz_drivers.panels.control_functions import ControlFunction, MappedControl
from woz_tui.drivers.contract import DriverError

#: A knob is heard as one when it has sent so many different values: nobody touches it by chance.
_VALUES = 3
_NUMBERED = {CC: "cc", NOTE: "note", PROGRAM: "program"}
#: What a map can name: how hard a pad is held answers no question.
_NAMED = (*_NUMBERED, BEND)
#: Fields of `ControlMapping` that say what a control sends or looks like, not what it does.
_PHYSICAL = ("cc", "note", "program", "bend", "channel", "kind", "column", "row", "lamp")


@dataclass(frozen=True, slots=True)
class LearntControl:
    """One answer: the control that was heard, for the question it was heard for."""

    question: int
    signal: MidiSignal
    name: str


class MapLearning:
    """One run through the questions.

    Args:
        panel: The map whose targets are asked for.
        card: What the panel's sound card is called; empty for a bare path.
        fd: Where its bytes come from; -1 for a lesson without a panel.
        keep: Whether targets that are not learnt stay where `panel` has them.
    """

    def __init__(self, panel: PanelMap, card: str, fd: int, *, keep: bool = False) -> None:
        self._panel = panel
        self._card = card
        self._fd = fd
        self._keep = keep
        self._decoder = MidiDecoder()
        self._layout = panel.layout if keep else _layout_of(card)
        self._known = controls_by_signal(
            mapped_controls(MidiSettings(map=PanelMap(layout=self._layout)))
        )
        self._asked = [it for it in mapped_controls(MidiSettings(map=panel)) if not it.free]
        self._taught: list[LearntControl] = []
        self._heard: dict[MidiSignal, set[int]] = {}
        self.at = 0

    # -- the conversation ----------------------------------------------------------------------

    @property
    def over(self) -> bool:
        """Whether all has been asked."""
        return self.at >= len(self._asked)

    @property
    def question(self) -> str:
        """What to do now, for whoever sits at the panel."""
        it = self._asked[self.at]
        what = "press the button" if it.pressed else "move the knob or slider"
        return f"[{self.at + 1}/{len(self._asked)}] {what} for: {it.label or it.name}"

    def skip(self) -> None:
        """Leave this target without a control."""
        self.at += 1
        self._heard.clear()

    def back(self) -> None:
        """Ask the question before again; its answer is forgotten."""
        self.at = max(self.at - 1, 0)
        self._taught = [one for one in self._taught if one.question < self.at]
        self._heard.clear()

    def fileno(self) -> int:
        """For `select`: readable when the panel has said something."""
        return self._fd

    def hear(self) -> str:
        """Read what the panel has said; a sentence if that was an answer, or a wrong one. Raises
        `DriverError` when the panel is gone.
        """
        try:
            data = os.read(self._fd, 4096)
        except BlockingIOError:
            return ""
        except OSError as error:
            raise DriverError(f"the panel is disconnected: {error.strerror or error}") from error
        if not data:
            raise DriverError("the panel is disconnected: it delivers no more data")
        return self.add(data)

    def add(self, data: bytes) -> str:
        """The same for bytes that were read already."""
        for message in self._decoder.feed(data):
            sentence = "" if self.over else self._message(message)
            if sentence:
                return sentence
        return ""

    def _message(self, message: MidiMessage) -> str:
        if message.kind not in _NAMED:
            return ""
        signal = MidiSignal(message.kind, message.number, message.channel)
        values = self._heard.setdefault(signal, set())
        values.add(message.value)
        it = self._asked[self.at]
        if not (_pressed(message, values) if it.pressed else len(values) >= _VALUES):
            return ""
        for one in self._taught:
            if one.signal == signal:
                if one.question == self.at - 1:
                    return ""  # the hand has not left it yet
                label = self._asked[one.question].label
                values.clear()
                return (
                    f"{one.name} is used for {label} already; use another one, or press b to"
                    " go back"
                )
        name = self._name(signal)
        self._taught.append(LearntControl(self.at, signal, name))
        self.skip()
        return f"{name}: {it.label}"

    def _name(self, signal: MidiSignal) -> str:
        known = self._known.get(MidiSignal(signal.kind, signal.number)) or self._known.get(signal)
        if known is not None:
            return known.name
        channel = f"-{signal.channel}" if signal.channel > 1 else ""
        return f"{signal.kind}-{signal.number}{channel}"

    # -- the file ------------------------------------------------------------------------------

    @property
    def count(self) -> int:
        """How many controls have been learnt."""
        return len(self._taught)

    def text(self) -> str:
        """The map file with what has been learnt so far."""
        head = {
            "title": self._panel.title or "learnt panel",
            "layout": self._layout,
            "device": self._card or (self._panel.device if self._keep else ""),
        }
        controls = {one.name: self._entry(one) for one in self._taught}
        if self._keep:
            controls |= self._left(set(controls))
        plain = {name: value for name, value in head.items() if value}
        return map_yaml({**plain, "controls": controls})

    def _entry(self, one: LearntControl) -> dict[str, object]:
        it = self._asked[one.question]
        doing = replace(it.mapped, **{name: _DEFAULTS[name] for name in _PHYSICAL})
        return {**self._sends(one, it), **mapping_entries(doing)}

    def _left(self, taken: set[str]) -> dict[str, dict[str, object]]:
        """What the map says already of targets that were not learnt."""
        learnt = {one.question for one in self._taught}
        return {
            it.name: mapping_entries(it.mapped)
            for question, it in enumerate(self._asked)
            if question not in learnt and it.name not in taken
        }

    def _sends(self, one: LearntControl, it: MappedControl) -> dict[str, object]:
        """What the file must say of the control itself; nothing for one that a layout knows."""
        if one.name in LAYOUTS[self._layout].controls:
            return {}
        signal = one.signal
        sends: dict[str, object] = {"kind": it.control.kind, "channel": signal.channel}
        if signal.kind == BEND:
            return {**sends, "bend": True}
        return {**sends, _NUMBERED[signal.kind]: signal.number}

    def close(self) -> None:
        """Let go of the panel."""
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1


def begin_learning(device: str, settings: MidiSettings, *, keep: bool) -> MapLearning:
    """Open the panel `device` (path, card's name; empty: the first one). Raises `DriverError`."""
    path, fd, _ = devices.open_one(device, Path.cwd())
    card = next((it.card for it in devices.present_devices() if it.path == path), "")
    return MapLearning(settings.panel, card, fd, keep=keep)


def map_text(panel: PanelMap) -> str:
    """A map file that says the same as `panel`."""
    head = {
        name: value for name in ("title", "layout", "device") if (value := getattr(panel, name))
    }
    listed = mapped_controls(MidiSettings(map=panel))
    controls = {it.name: mapping_entries(it.mapped) for it in listed if it.name in panel.controls}
    return map_yaml({**head, "controls": controls})


def mapping_entries(mapped: ControlFunction) -> dict[str, object]:
    """What a file must say of a control: everything that is not as it would be without."""
    entries = {}
    for item in fields(mapped):
        value = getattr(mapped, item.name)
        if value != _DEFAULTS[item.name]:
            entries[item.name] = list(value) if isinstance(value, tuple) else value
    return entries


def map_yaml(content: dict[str, object]) -> str:
    """YAML with one line for each control."""
    lines = []
    for name, value in content.items():
        if not isinstance(value, dict):
            lines.append(yaml.safe_dump({name: value}, allow_unicode=True).rstrip())
            continue
        lines.append(f"{name}:" if value else f"{name}: {{}}")
        for key, entry in value.items():
            flow = yaml.safe_dump(
                entry, default_flow_style=True, allow_unicode=True, width=10_000, sort_keys=False
            )
            lines.append(f"  {key}: {flow.strip()}")
    return "\n".join(lines) + "\n"


def _pressed(message: MidiMessage, values: set[int]) -> bool:
    """Whether it is a button that goes down, and no slider on its way past."""
    if message.kind in (NOTE, PROGRAM):
        return message.value > 0
    return message.kind == CC and message.value == 127 and values <= {0, 127}


def _layout_of(card: str) -> str:
    """The layout of a panel whose sound card is called `card`."""
    for name, layout in LAYOUTS.items():
        if layout.device and layout.device.casefold() == card.casefold():
            return name
    return "none"


_BLANK = ControlMapping()
_DEFAULTS = {item.name: getattr(_BLANK, item.name) for item in fields(_BLANK)}
