"""woz-tui: a wizard plays a social robot from a terminal.

A key press becomes the name of an action. The console sends it over a Unix socket to the robot
process (`host`), which looks the action up in the `experiment`, turns its steps into commands
(`session`), has the hub record each command before anything moves (`record`), and puts it on the
`bus`. The bus gives it to the driver's worker; the driver talks to the hardware and returns what
was really sent. Acknowledgements, sensor readings and changes of state travel back as messages
through the same hub: to the log, to every attached console, to any program that listens. The stop
takes none of these queues.
"""

__version__ = "0.2.0.dev0"
