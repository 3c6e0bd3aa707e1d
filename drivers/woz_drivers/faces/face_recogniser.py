"""The program that recognises faces, beside the robot process: crops in, names out.

    python -m woz_drivers.faces.face_recogniser --models FOLDER [--alike 0.45]

It stays loaded and speaks the lines of `woz_drivers.programs.resident_program`. A request is about
one face, given as `crop`: 112 x 112 pixels, red, green and blue, in base64, with the eyes, the nose
and the corners of the mouth at the places of `CROP_PLACES` (`face_geometry`).

    {"id": 1, "do": "identify", "crop": "..."}          -> {"id": 1, "name": "V3", "likeness": 0.81}
    {"id": 2, "do": "take", "anew": true, "crop": "..."} -> {"id": 2}        kept in memory alone
    {"id": 3, "do": "learn", "name": "V3", "consented": "2026-03-01", "log": "..."} -> {"id": 3}
    {"id": 4, "do": "forget", "names": ["V3"]}          -> {"id": 4, "names": ["V3"]}
    {"id": 5, "do": "list"}                             -> {"id": 5, "names": ["V7"]}

`name` is empty for a stranger. An answer with `refused` (and `remedy`) did nothing. Templates stay
in this process and in the store (`face_store`): no answer has one, so no log can.
"""

from __future__ import annotations

import argparse
import base64
import importlib
import json
import os
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from woz_drivers.faces import models
from woz_drivers.faces.face_geometry import CROP_SIDE
from woz_drivers.faces.face_networks import Floats
from woz_tui.drivers.contract import DriverError
from woz_tui.drivers.face_store import FaceStore, default_path, key_of
from woz_tui.system.extras import install_command

#: Of a network that recognises faces: a crop (112 x 112 x 3, 0 to 255) in, 128 numbers out.
Recognition = Callable[[Floats], Floats]
#: Those numbers, together of length 1.
Template = Floats
#: So many crops are kept in memory at most while a face is learnt.
_MOST = 20


class FaceRecogniser:
    """Answers requests. Faces are the same person's if they are `alike` (cosine) at least."""

    def __init__(self, network: Recognition, store: FaceStore, alike: float) -> None:
        self._network, self._store, self._alike = network, store, alike
        self._taken: list[Template] = []

    def answer(self, request: dict[str, Any]) -> dict[str, Any]:
        """What is answered, without the id. Raises `ValueError` for what is no request."""
        try:
            return self._answer(request)
        except DriverError as error:
            return {"refused": error.what, "remedy": error.remedy}
        except (KeyError, TypeError) as error:
            raise ValueError(f"{type(error).__name__}: {error}") from None

    def _answer(self, request: dict[str, Any]) -> dict[str, Any]:
        match request.get("do"):
            case "identify":
                name, likeness = self._nearest(self._template(request))
                known = likeness >= self._alike
                return {"name": name if known else "", "likeness": round(likeness, 3)}
            case "take":
                before = [] if request.get("anew") else self._taken
                self._taken = [*before, self._template(request)][-_MOST:]
            case "learn":
                self._learn(*(str(request[key]) for key in ("name", "consented", "log")))
            case "forget":
                return {"names": self._store.forget(map(str, request["names"]))}
            case "list":
                return {"names": [one.name for one in self._store.faces()]}
            case other:
                raise ValueError(f"no such request: {other!r}")
        return {}

    def _template(self, request: dict[str, Any]) -> Template:
        data = base64.b64decode(request["crop"], validate=True)
        crop = np.frombuffer(data, np.uint8).reshape(CROP_SIDE, CROP_SIDE, 3).astype(np.float32)
        numbers = self._network(crop).reshape(128)
        return (numbers / max(float(np.linalg.norm(numbers)), 1e-6)).astype(np.float32)

    def _likeness(self, template: Template) -> dict[str, float]:
        """How alike each face that is kept is: the cosine of the angle to its nearest template."""
        found: dict[str, float] = {}
        for one in self._store.faces():
            for kept in map(_numbers, one.templates):
                if kept.shape == template.shape:  # else another network made it
                    found[one.name] = max(found.get(one.name, -1.0), float(kept @ template))
        return found

    def _nearest(self, template: Template) -> tuple[str, float]:
        found = self._likeness(template)
        return max(found.items(), key=lambda one: one[1], default=("", 0.0))

    def _learn(self, name: str, consented: str, log: str) -> None:
        """Raises `DriverError`: it was not learnt."""
        taken, self._taken = self._taken, []
        if not taken:
            raise DriverError("there is no picture of a face", "take some before")
        mean = np.mean(taken, axis=0)
        mean = (mean / max(float(np.linalg.norm(mean)), 1e-6)).astype(np.float32)
        if min(float(one @ mean) for one in taken) < self._alike:
            raise DriverError(
                "the pictures do not show one face clearly",
                "let one person look at the camera from one metre in good light",
            )
        found = self._likeness(mean)
        own = next((kept for kept in found if key_of(kept) == key_of(name)), None)
        if own is not None and found[own] < self._alike:
            raise DriverError(
                f"another face is kept under the name {own}",
                f"choose another name, or `woz visitors forget {own}`",
            )
        other, likeness = self._nearest(mean)
        if likeness >= self._alike and other != own:
            raise DriverError(
                f"this face is kept already, under the name {other}",
                f"call them {other}, or `woz visitors forget {other}`",
            )
        self._store.learn(name, mean.astype("<f4").tobytes(), consented, log)


def _numbers(kept: bytes) -> Template:
    return np.frombuffer(kept[: len(kept) // 4 * 4], "<f4").astype(np.float32)


def serve(lines: Iterable[str], write: Callable[[str], object], recogniser: FaceRecogniser) -> None:
    """Answer line by line until they end."""
    write(json.dumps({"ready": True, "name": "face recogniser"}) + "\n")
    for line in lines:
        request = json.loads(line)
        try:
            answer = recogniser.answer(request)
        except ValueError as error:
            answer = {"error": str(error)}
        write(json.dumps({"id": request["id"], **answer}) + "\n")


def recognition(path: Path) -> Recognition:
    """SFace as OpenCV runs it, on one thread. Imported here: it is an extra. Raises `ImportError`,
    `DriverError`.
    """
    cv2: Any = importlib.import_module("cv2")
    cv2.setNumThreads(1)
    try:
        network = cv2.dnn.readNetFromONNX(str(path))
    except cv2.error as error:
        raise DriverError(f"OpenCV cannot read {path}: {error}", "install another one") from None

    def run(crop: Floats) -> Floats:
        network.setInput(np.ascontiguousarray(crop.transpose(2, 0, 1)[None]))
        found: Floats = network.forward()
        return found

    return run


def main() -> int:
    """Work until stdin ends."""
    parser = argparse.ArgumentParser(prog="python -m woz_drivers.faces.face_recogniser")
    parser.add_argument("--models", type=Path, default=models.default_folder())
    parser.add_argument("--alike", type=float, default=0.45)
    options = parser.parse_args()
    # Nothing but our lines may come out of stdout, whatever the library has to say.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    os.dup2(2, 1)
    try:
        [path] = models.checked(options.models, models.RECOGNISING)
        network = recognition(path)
    except DriverError as error:
        sys.stderr.write(f"{error.what}: {error.remedy}\n")
        return 1
    except ImportError as error:
        sys.stderr.write(f"{error}: {install_command('faces-identity')}\n")
        return 1
    serve(
        sys.stdin, answers.write, FaceRecogniser(network, FaceStore(default_path()), options.alike)
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
