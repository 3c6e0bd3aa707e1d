"""The words of the engagement model: states, outcomes, signs, modes."""

from __future__ import annotations

#: The nine states, in the order of a conversation, and the one after the last.
STATES = (
    *("Wait", "PersonDetected", "EngagedWithUnknown", "Handshake", "EngagedWithKnown"),
    *("UserSpeaks", "RobotThinks", "RobotReplies", "RobotSpeaks"),
)
STOPPED = "stop"
#: Names of the ways out of the states; `woz_tui.sensing.state_machine` has the ways themselves.
OUTCOMES = (
    *("end", "human_presence", "human_absence", "recognized", "unrecognized", "error"),
    *("handshake", "eng2know", "eng2unknow", "listening", "speaking", "done"),
)
#: What is sensed of a visitor. The first three make up the condition of engagement.
SIGNS = ("presence", "gaze", "distance", "identity")
CONDITION = SIGNS[:3]
#: The identity of somebody without a name.
UNKNOWN = "Unknown"
FILTERS = ("fifo", "median", "joint")
START_UPS = ("zero-fill", "partial", "hold")
RUNS = ("run", "hold", "off")
#: What may end a turn of a conversation before it is over: its visitor leaves it; or, as in the
#: paper, nothing.
VISITOR, PAPER = TURNS = ("visitor", "paper")
MODES = ("Unengaged", "FullyEngaged", "SemiEngaged")
CAMERAS = ("body", "head")
