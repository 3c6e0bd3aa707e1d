"""A MIDI panel: knobs, sliders and buttons in the puppeteer's hands.

`wire` knows MIDI, `devices` and `port` the operating system, `layouts` makes of panels, `mapped`,
`rules`, `settings` and `maps` what controls do, `pickup` and `hands` how a hand gets hold of a
value, `driver` puts them together.
"""

from woz_drivers.midi.driver import MidiPanel

__all__ = ["MidiPanel"]
