"""The words of a study."""

from __future__ import annotations

#: What a cue is, to which a robot's answer may come too soon.
CUES = ("speech", "engagement", "marker")
#: What of the screen can be kept from the wizard; all but `transcript` can only be hidden.
PERCEIVED = (
    *("transcript", "distance", "loudness", "presence", "gaze", "identity", "direction"),
    *("engagement", "joints", "face"),
)
BLURRED = ("transcript", "distance", "loudness")

#: Outcomes after which the next trial comes; an aborted one is run again.
OVER = ("done", "excluded")
