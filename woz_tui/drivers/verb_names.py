"""Verbs whose names all drivers share, so that one experiment runs on many robots."""

from __future__ import annotations

from collections.abc import Mapping

#: Main argument of each.
COMMON_VERBS: Mapping[str, str] = {
    "say": "text",
    "play": "move",
    "pose": "joints",
    "poses": "poses",
    "home": "seconds",
    "gaze": "yaw",
    "nudge": "yaw",
    "torque": "on",
    "emotion": "emotion",
    "eyes": "color",
    "screen": "file",
    "sound": "file",
    "drive": "x",
    "mode": "mode",
    "volume": "level",
    "learn_face": "name",
    "listen_room": "seconds",
}
