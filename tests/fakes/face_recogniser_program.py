"""The program that recognises faces with a stand-in for its network: a face is the grey it has.

Everything but the network is the real one, the store too. Faces of the same grey (in steps of 16)
are one person's; other people's templates have nothing to do with each other.
"""

from __future__ import annotations

import sys

import numpy as np
from woz_drivers.faces.face_networks import Floats
from woz_drivers.faces.face_recogniser import FaceRecogniser, serve

from woz_tui.drivers.face_store import FaceStore, default_path

#: The program ends at a face of this grey.
FALLS_OVER = 240


def network(crop: Floats) -> Floats:
    """What is made of a crop."""
    grey = int(crop[40:80, 40:80].mean())
    if grey >= FALLS_OVER:
        sys.exit("out of memory")
    found: Floats = np.random.default_rng(grey // 16).normal(size=128).astype(np.float32)
    return found


def _write(line: str) -> None:
    sys.stdout.write(line)
    sys.stdout.flush()


if __name__ == "__main__":
    serve(sys.stdin, _write, FaceRecogniser(network, FaceStore(default_path()), 0.45))
