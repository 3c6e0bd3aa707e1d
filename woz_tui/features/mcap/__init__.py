"""MCAP: sessions for the viewers of robots' recordings, such as Foxglove or Lichtblick."""

from woz_tui.feature import Feature


class Mcap(Feature):
    """The format `mcap` of `woz export`."""

    name = "mcap"
    exporters = "exporter:EXPORTERS"
