"""Experiment files of the end-to-end tests."""

from __future__ import annotations

from pathlib import Path

#: A simulated robot that speaks for long and drives far. A console on a crowded machine may be
#: silent for longer than a second, and a key may wait there before it is read.
GUIDE = """\
title: Long way
robot: {robot}
conditions: [warm, cold]
variables: {{room: the hall}}
session: {{abandon_after: {abandon} s, dead_man: 3 s, stale_after: 30 s}}
panels:
  - title: Speech
    actions:
      - {{key: h, label: Hello, say: "Hello {{participant}}."}}
      - {{key: l, label: Long story, say: "{story}"}}
      - {{key: n, label: Nod, play: nod}}
  - title: Driving
    actions:
      - {{key: F, label: Far away, drive: 5}}
      - {{key: x, label: Fails, steps: [{{fault: fail, part: body}}, {{play: nod}}]}}
script: [Hello, Nod, Hello, Nod]
"""
STORY = "Once upon a time there was a robot who liked to talk. "


def guide(robot: str = "simulated", *, abandon: float = 60, story: str = STORY) -> str:
    """The experiment `GUIDE`."""
    return GUIDE.format(robot=robot, abandon=abandon, story=story.strip())


#: A head of three servos over `port`; `more` are further drivers of the robot. On a crowded machine
#: an answer takes longer than on any wire, and what stands still for a while must not be stopped.
HEAD = """\
title: Bench
robot:
  name: bench
  drivers:
    head:
      type: dynamixel
      port: {port}
      pan: pan
      tilt: tilt
      joints:
        pan: {{id: 11, min: -60, max: 60, speed: 120}}
        tilt: {{id: 12, min: -20, max: 30, speed: 120, rest: 15}}
        roll: {{id: 13, min: -20, max: 20, speed: 90}}
      rest_speed: 120
      reply_timeout: 500
      watchdog: 2500
      moves:
        nod: [{{tilt: 14, seconds: 0.3}}, {{tilt: 0, seconds: 0.3}}]
{more}
session: {{abandon_after: {abandon} s, stale_after: 30 s}}
panels:
  - title: Head
    actions:
      - {{key: "1", label: Left, pose: {{pan: 40, seconds: 0.5}}}}
      - {{key: "2", label: Middle, pose: {{pan: 0, tilt: 0, roll: 0, seconds: 0.5}}}}
      - {{key: "3", label: Slowly right, pose: {{pan: -50, tilt: 20, roll: 10, seconds: 8}}}}
      - {{key: n, label: Nod, play: nod}}
  - title: Power
    actions:
      - {{key: f9, label: Torque on, torque: on}}
      - {{key: f8, label: Torque off, torque: off}}
      - {{key: f7, label: Restart, reboot: ""}}
"""
#: Degrees of each joint by servo id: lowest, highest, degrees a second.
JOINTS = {11: (-60.0, 60.0, 120.0), 12: (-20.0, 30.0, 120.0), 13: (-20.0, 20.0, 90.0)}


def head(port: Path, more: str = "", *, abandon: float = 60) -> str:
    """The experiment `HEAD`."""
    return HEAD.format(port=port, more=more.rstrip(), abandon=abandon)
