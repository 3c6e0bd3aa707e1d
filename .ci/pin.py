"""Write constraints.txt: one exact version of every package, good for each Python and processor.

Versions are looked up for the oldest Python, because what it can run the newer ones can too; the
result is then tried for every pair of Python and processor. Nothing is installed.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
FILE = ROOT / "constraints.txt"
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
PROCESSORS = ("x86_64", "aarch64")
GLIBCS = (
    "manylinux_2_28",
    "manylinux_2_27",
    "manylinux_2_17",
    "manylinux2014",
    "manylinux_2_12",
    "manylinux2010",
)
HEADER = """\
# Exact versions of everything woz-tui runs and is developed with, for Python 3.11 to 3.14 on
# x86-64 and 64-bit ARM. Made by `make constraints`; do not edit.
"""


def requirements(python: str, processor: str) -> list[str]:
    """What pyproject.toml asks for there, to run, to develop and to build.

    pip would judge markers by the machine that it runs on.
    """
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    extras: list[str] = project["project"]["optional-dependencies"]["dev"]
    every = [*project["project"]["dependencies"], *extras, *project["build-system"]["requires"]]
    target = {"python_version": python, "platform_machine": processor}
    wanted = [Requirement(text) for text in every]
    return [
        f"{one.name}{one.specifier}"
        for one in wanted
        if one.marker is None or one.marker.evaluate(target)
    ]


def resolve(python: str, processor: str, options: list[str]) -> dict[str, str]:
    """Names and versions pip would install there; exits with pip's words if it cannot."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        platforms = [f"--platform={glibc}_{processor}" for glibc in GLIBCS]
        subprocess.run(
            [
                *(sys.executable, "-m", "pip", "install", "--dry-run", "--quiet"),
                *("--ignore-installed", "--only-binary=:all:", f"--target={folder}/none"),
                *(f"--python-version={python}", f"--report={report}", *platforms),
                *(*options, *requirements(python, processor)),
            ],
            check=True,
        )
        return dict(sorted(_versions(json.loads(report.read_text()))))


def _versions(report: Mapping[str, list[dict[str, dict[str, str]]]]) -> Iterator[tuple[str, str]]:
    for item in report["install"]:
        metadata = item["metadata"]
        yield metadata["name"].lower().replace("_", "-"), metadata["version"]


def main() -> None:
    """Pin, then try every pair."""
    pins = resolve(PYTHONS[0], PROCESSORS[0], [])
    with tempfile.TemporaryDirectory() as folder:
        draft = Path(folder) / "constraints.txt"
        draft.write_text(HEADER + "".join(f"{name}=={version}\n" for name, version in pins.items()))
        for python in PYTHONS:
            for processor in PROCESSORS:
                found = resolve(python, processor, ["-c", str(draft)])
                unpinned = sorted(found.keys() - pins.keys())
                if unpinned:
                    sys.exit(f"Python {python} on {processor} also needs {', '.join(unpinned)}")
                sys.stdout.write(f"Python {python} on {processor}: {len(found)} packages\n")
        FILE.write_text(draft.read_text())


if __name__ == "__main__":
    main()
