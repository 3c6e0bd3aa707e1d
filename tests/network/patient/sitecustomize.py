"""A Python with this folder in PYTHONPATH is as patient with drivers at other computers as
`tests.network.other_computer`: on a busy machine a second of silence is no loss.
"""

from woz_tui.network import driver_line

SILENCE_S = 3.0

driver_line.SILENCE_S = SILENCE_S  # for the modules that take it from there, imported later
