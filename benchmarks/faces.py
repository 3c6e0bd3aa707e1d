"""What faces from a camera cost; who is found, and recognised, in pictures that are tilted, small,
dark, blurred.

    python benchmarks/faces.py [--pictures 200] [--quick]

Needs the peer `faces` (`make peers`, or `.ci/peers --install faces`), whose Python runs the
networks: bare calls of the interpreter, and our program with whole pictures around them, in turns
in one process. Pictures are 640 x 480, yuv420 as cameras have it. A Raspberry Pi 4 is taken to need
four times as long as one core of a server, which was not measured.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from woz_drivers.faces.face_lines import SeenFace
from woz_drivers.faces.face_tracks import FaceTracker, distance_of, gaze_of

from benchmarks.figures import Spread, machine, table, verdict
from tests.drivers.camera.pictures import planes
from tests.peers.face_pictures import (
    CHANGES,
    NOBODY,
    FindingProgram,
    RecognisingProgram,
    changed_picture,
    crossing,
    faces_in,
    fitted,
    on_grey,
    open_picture,
    whose,
)
from tests.peers.places import PEERS

PEER = PEERS / "faces"
#: So many times as long as a core of a server a Raspberry Pi 4 is taken to need.
PI = 4.0
#: Readings a second that are wanted of one Raspberry Pi's core.
WANTED_HZ = 10.0
#: Runs in the peer's Python: bare calls and whole pictures in turns; milliseconds of the processor
#: as JSON, since other programs keep the cores busy.
_TIMES = """
import json, sys, time
import numpy as np
from woz_drivers.camera.raw_pictures import PictureLayout
from woz_drivers.faces import models
from woz_drivers.faces.face_networks import FaceNetworks, PictureSampler, interpreted
from woz_drivers.faces.face_finder import answer
from pathlib import Path

import numpy as np
folder, count, *films = sys.argv[1:]
nets = [interpreted(str(path)) for path in models.checked(Path(folder))]
whole = FaceNetworks(PictureSampler(PictureLayout(640, 480, "yuv420", 640)), *nets, far=True)
films = {Path(name).stem: Path(name).read_bytes() for name in films}
sides = {"detection": 192, "mesh": 192, "iris": 64}
inputs = [np.zeros((1, side, side, 3), np.float32) for side in sides.values()]
times = {name: [] for name in (*sides, *films)}
for n in range(int(count) + 3):
    for name, run in (
        *((name, lambda net=net, x=x: net(x)) for name, net, x in zip(sides, nets, inputs)),
        *((name, lambda data=data: answer(whole, data, 10)) for name, data in films.items()),
    ):
        began = time.process_time()
        run()
        if n >= 3:
            times[name].append((time.process_time() - began) * 1000)
print(json.dumps(times))
"""


def measured_times(pictures: int, folder: Path) -> dict[str, list[float]]:
    """Milliseconds of each network alone, and of a picture with one person and with six."""
    one = changed_picture(open_picture(PEER, "astronaut.png"), "as it is")
    six = on_grey((fitted(open_picture(PEER, "group.jpg")), 320, 240))
    files = []
    for name, picture in (("one", one), ("six", six)):
        path = folder / f"{name}.rgb"
        path.write_bytes(planes(np.asarray(picture), picture.width))
        files.append(str(path))
    words = [
        str(PEER / "bin" / "python"),
        "-c",
        _TIMES,
        str(PEER / "networks"),
        str(pictures),
        *files,
    ]
    ran = subprocess.run(words, capture_output=True, text=True, check=True)
    found: dict[str, list[float]] = json.loads(ran.stdout.splitlines()[-1])
    return found


def time_rows(times: dict[str, list[float]]) -> Iterator[tuple[str, ...]]:
    """A row for each: median, 99th percentile, and what is estimated for a Pi 4."""
    spreads = {name: Spread.of(values) for name, values in times.items()}
    # In the picture with six some faces are too small for their irises to be looked at.
    bare = spreads["detection"].p50 + spreads["mesh"].p50 + 2 * spreads["iris"].p50
    words = {"one": "a picture with one person", "six": "a picture with six people"}
    for name, spread in spreads.items():
        title = words.get(name, f"the network {name} alone")
        extra = f"{spread.p50 / bare:.2f}" if name == "one" else ""
        pi = f"{PI * spread.p50:.0f} ms, {1000 / (PI * spread.p50):.0f}/s" if name in words else ""
        yield title, f"{spread.p50:.2f}", f"{spread.p99:.2f}", extra, pi


# -- what is found ---------------------------------------------------------------------------------


def accuracy_rows(program: FindingProgram) -> Iterator[tuple[str, ...]]:
    """A row for each way in which pictures are changed."""
    focal = program.settings.focal
    pictures = {name: open_picture(PEER, name) for name in ("astronaut.png", "group.jpg")}
    [one] = program.people(changed_picture(pictures["astronaut.png"], "as it is"))
    upright = one.face
    for change, (degrees, scale, *_) in CHANGES.items():
        people = {
            name: program.people(changed_picture(one, change)) for name, one in pictures.items()
        }
        counts = {name: len(there) for name, there in people.items()}
        face = people["astronaut.png"][0].face if people["astronaut.png"] else None
        row = [change, f"{counts['astronaut.png']} of 1", f"{counts['group.jpg']} of 6"]
        if face is None:
            yield *row, "", "", ""
            continue
        expected = -2 * (upright.roll or 0) if change == "mirrored" else degrees
        ratio = distance_of(face, focal) / distance_of(upright, focal)
        yield (
            *row,
            f"{ratio * scale - 1:+.0%}",
            f"{(face.roll or 0) - (upright.roll or 0):+.0f} ({expected:+.0f})",
            _gaze_change(face, upright, mirrored=change == "mirrored"),
        )


def _gaze_change(face: SeenFace, upright: SeenFace, *, mirrored: bool) -> str:
    now, before = gaze_of(face), gaze_of(upright)
    if now is None or before is None:
        return ""
    yaw = -now[0] if mirrored else now[0]
    return f"{math.hypot(yaw - before[0], now[1] - before[1]):.0f}"


def nobody_row(program: FindingProgram) -> str:
    """In how many pictures without a person somebody was found."""
    false = [
        name
        for name in NOBODY
        if program.people(on_grey((fitted(open_picture(PEER, name)), 320, 240)))
    ]
    return f"pictures without a person: somebody in {len(false)} of {len(NOBODY)}"


def crossing_row(program: FindingProgram) -> str:
    """How often two people who cross were two, and how many numbers they got."""
    tracker, numbers, two, alone = FaceTracker(1.0), set[int](), 0, 0
    pictures = [program.find(picture).faces for picture in crossing(PEER)]
    for n, faces in enumerate(pictures):
        there = tracker.update(faces, n * 100_000)
        numbers.update(track.id for track in there)
        two += len(there) == 2
        alone += len(faces) == 2
    return (
        f"two people who cross, {len(pictures)} pictures: two faces in {alone},"
        f" two people in {two}, {len(numbers)} numbers"
    )


def identity_rows(program: FindingProgram, state: Path) -> Iterator[tuple[str, ...]]:
    """A row for each change: all seven people are learnt from the pictures as they are. Each is a
    stranger to a store that has the six others.
    """
    pictures = {"one": open_picture(PEER, "astronaut.png"), "six": open_picture(PEER, "group.jpg")}
    as_it_is = {key: changed_picture(picture, "as it is") for key, picture in pictures.items()}
    people = {
        key: {f"{key}{n}": face for n, face in enumerate(faces_in(program, picture))}
        for key, picture in as_it_is.items()
    }
    names = [name for each in people.values() for name in each]
    with contextlib.ExitStack() as stack:
        stores = {
            absent: stack.enter_context(RecognisingProgram(PEER, state / absent))
            for absent in ("nobody", *names)
        }
        for key, each in people.items():
            for name, face in each.items():
                for absent, store in stores.items():
                    if absent != name:
                        store.learn(name, as_it_is[key], face)
        for change in CHANGES:
            found = [
                (owner, shown, face)
                for key, picture in pictures.items()
                for shown in (changed_picture(picture, change),)
                for face in faces_in(program, shown)
                if (owner := whose(face, people[key], change)) is not None
            ]
            told = [
                (owner, *stores["nobody"].identify(shown, face)) for owner, shown, face in found
            ]
            right = sum(name == owner for owner, name, _ in told)
            wrong = sum(name not in ("", owner) for owner, name, _ in told)
            strange = [stores[owner].identify(shown, face)[1] for owner, shown, face in found]
            spread = [likeness for *_, likeness in told]
            yield (
                change,
                f"{right} of {len(found)}",
                str(wrong),
                f"{min(spread):.2f} to {max(spread):.2f}" if spread else "",
                f"{max(strange):.2f}" if strange else "",
            )


def main() -> int:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--pictures", type=int, default=200)
    parser.add_argument("--quick", action="store_true")
    words = parser.parse_args()
    if not (PEER / ".installed").exists():
        print("the peer faces is not installed: .ci/peers --install faces", file=sys.stderr)
        return 1
    print(machine())
    times = measured_times(5 if words.quick else words.pictures, PEER)
    heads = ("", "p50 ms", "p99 ms", "by its networks alone", "a Pi 4, estimated")
    table("Time for a picture", heads, [*time_rows(times)])
    one = Spread.of(times["one"]).p50 * PI
    print(f"{WANTED_HZ:g} readings a second on a Pi 4, estimated: {verdict(one, 1000 / WANTED_HZ)}")
    with FindingProgram(PEER) as program:
        what = ("", "one person", "group", "distance", "roll, degrees", "gaze changes, degrees")
        table("What is found", what, [*accuracy_rows(program)])
        with tempfile.TemporaryDirectory() as state:
            heads = ("", "recognised", "by a wrong name", "likeness", "strangers, highest")
            table("Who is recognised", heads, [*identity_rows(program, Path(state))])
        print(nobody_row(program))
        print(crossing_row(program))
    return 0


if __name__ == "__main__":
    sys.exit(main())
