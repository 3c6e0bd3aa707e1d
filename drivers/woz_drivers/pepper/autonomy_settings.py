"""What of the robot's autonomy can be switched, and by which service of NAOqi."""

from __future__ import annotations

#: Settings with a service of their own that is switched by `setEnabled`.
ABILITIES = {
    "awareness": "ALBasicAwareness",
    "blinking": "ALAutonomousBlinking",
    "listening_movement": "ALListeningMovement",
    "speaking_movement": "ALSpeakingMovement",
}

#: Settings of `ALMotion.setBreathEnabled`, and their chains: the whole body before its parts.
CHAINS = {
    "body_breathing": "Body",
    "head_breathing": "Head",
    "arms_breathing": "Arms",
    "legs_breathing": "Legs",
}

#: Distances kept, what from, and how NAOqi calls them.
DISTANCES = {
    "tangential": ("what it drives along", "Tangential"),
    "orthogonal": ("what it drives towards", "Orthogonal"),
}

#: All that is on or off, and what it is.
FLAGS = {
    "awareness": "turns to people and sounds",
    "blinking": "blinks",
    "listening_movement": "moves slightly while it listens",
    "speaking_movement": "moves while it speaks",
    "head_breathing": "the head breathes",
    "arms_breathing": "the arms breathe",
    "body_breathing": "the whole body breathes",
    "legs_breathing": "the leg breathes",
}
