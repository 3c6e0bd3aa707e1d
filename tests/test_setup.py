"""What a user installs: both packages, the examples, the entry points - and nobody's recordings."""

from __future__ import annotations

import configparser
import json
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from collections.abc import Iterator
from email import message_from_bytes
from importlib.metadata import distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from hatch_build import IndexPage
from woz_tui import __version__

pytestmark = pytest.mark.timeout(300)  # it builds both packages

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
#: What no package may contain, wherever in the tree somebody left it.
PRIVATE = "2026-02-03T04-05-06_P99_S99"
#: What sessions leave behind in a clone: logs, trainings, voices, pictures, names, access files.
LEFT_BEHIND = (
    f"recordings/{PRIVATE}.jsonl",
    f"recordings/{PRIVATE}.samples.index",
    f"recordings/{PRIVATE}.media/ears-0001.wav",
    f"recordings/{PRIVATE}.media/frames-eye/000001.png",
    f"recordings/training/{PRIVATE}.samples.jsonl",
    "recordings/visitors.json",
    f"experiments/{PRIVATE}.jsonl",
    f"experiments/robots/{PRIVATE}.media/ears-0001.wav",
    f"experiments/recordings/{PRIVATE}.jsonl",
    f"experiments/recordings/{PRIVATE}.media/ears-0001.wav",
    "experiments/recordings/visitors.json",
    f"lab/recordings/{PRIVATE}.jsonl",
    "experiments/bea.access",
    "bea.access",
)


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[str], Path]:
    """The sdist's names (without its top folder) and the wheel, built from a copy of the tree."""
    copy = tmp_path_factory.mktemp("setup") / "project"
    shutil.copytree(
        ROOT,
        copy,
        # What tests that run beside this one compile comes and goes meanwhile.
        ignore=shutil.ignore_patterns(
            *("__pycache__", ".*cache*", ".venv", ".git", "dist", ".hypothesis")
        ),
    )
    for name in LEFT_BEHIND:
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        (copy / name).write_text("{}\n")
    for words in (["init"], ["add", "pyproject.toml"], ["commit", "-m", "for the test"]):
        who = ["-c", "user.name=A", "-c", "user.email=a@example.org"]
        subprocess.run(["git", "-C", copy, *who, *words], check=True, capture_output=True)
    done = subprocess.run(
        [
            sys.executable,
            "-m",
            "build",
            "--no-isolation",
            "--outdir",
            str(copy / "dist"),
            str(copy),
        ],
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    [sdist] = (copy / "dist").glob("*.tar.gz")
    [wheel] = (copy / "dist").glob("*.whl")
    with tarfile.open(sdist) as archive:
        names = [name.partition("/")[2] for name in archive.getnames()]
    return names, wheel


def shipped(folder: str) -> list[str]:
    """Paths under `folder`, relative to it, of all files that sessions and Python did not make."""
    made = re.compile(r"(^|/)(__pycache__|recordings|[^/]+\.media)/|\.(jsonl|log|access)$")
    paths = (
        path.relative_to(ROOT / folder).as_posix()
        for path in sorted((ROOT / folder).rglob("*"))
        if path.is_file()
    )
    return [path for path in paths if not made.search(path)]


def test_the_wheel_has_every_file_of_the_packages_and_examples(
    packages: tuple[list[str], Path],
) -> None:
    names = set(zipfile.ZipFile(packages[1]).namelist())
    drivers = {path.parent.name for path in (ROOT / "drivers").glob("*/__init__.py")}
    assert "robot_simulators" in drivers
    folders = {
        "woz_tui": "woz_tui",
        "woz_tui/_experiments": "experiments",
        **{name: f"drivers/{name}" for name in drivers},
    }
    wanted = {f"{name}/{path}" for name, folder in folders.items() for path in shipped(folder)}
    assert {"woz_tui/_experiments/demo.yaml", "woz_tui/console/drawing/woz.tcss"} <= wanted
    assert {f"{package}/py.typed" for package in {"woz_tui", *drivers}} <= wanted
    assert not wanted - names


def test_the_wheel_registers_command_and_drivers(packages: tuple[list[str], Path]) -> None:
    with zipfile.ZipFile(packages[1]) as wheel:
        [name] = [name for name in wheel.namelist() if name.endswith("/entry_points.txt")]
        points = configparser.ConfigParser()
        points.read_string(wheel.read(name).decode())
    assert dict(points["console_scripts"]) == {"woz": "woz_tui.cli:program"}
    assert dict(points["woz_tui.drivers"]) == PROJECT["project"]["entry-points"]["woz_tui.drivers"]


def test_wheel_and_sdist_say_of_which_commit_they_are(packages: tuple[list[str], Path]) -> None:
    assert "woz_tui/_source.json" in packages[0]
    with zipfile.ZipFile(packages[1]) as wheel:  # it was made from the sdist
        told = json.loads(wheel.read("woz_tui/_source.json"))
    copy = packages[1].parents[1]
    head = subprocess.run(
        ["git", "-C", copy, "rev-parse", "HEAD"], capture_output=True, text=True, check=True
    )
    assert told == {"commit": head.stdout.strip(), "dirty": "yes"}  # most files are in no commit


def test_the_version_is_that_of_the_newest_changes(packages: tuple[list[str], Path]) -> None:
    """A release has a heading with its date; what comes after it is not released yet."""
    assert packages[1].name.startswith(f"woz_tui-{__version__}-")
    text = (ROOT / "CHANGELOG.md").read_text()
    newest = re.findall(r"^## (.*)$", text, flags=re.MULTILINE)[0]
    if Version(__version__).is_prerelease:
        assert newest == "Unreleased"
    else:
        assert re.fullmatch(rf"{re.escape(__version__)} - \d{{4}}-\d\d-\d\d", newest)


def test_the_page_of_the_package_index_has_no_link_that_leads_nowhere(
    packages: tuple[list[str], Path],
) -> None:
    with zipfile.ZipFile(packages[1]) as wheel:
        [name] = [name for name in wheel.namelist() if name.endswith("/METADATA")]
        told = message_from_bytes(wheel.read(name))
    assert told["Description-Content-Type"] == "text/markdown"
    page = str(told.get_payload())
    assert page.startswith("# woz-tui\n")
    relative = re.findall(r"(?<!!)\[([^]]*)\]\((?!https?:)", (ROOT / "README.md").read_text())
    assert relative and all(words in page for words in relative)
    assert re.findall(r"\]\((?!https?:)", page) == []


def test_the_page_of_the_package_index_leads_to_the_repository_once_it_has_an_address(
    tmp_path: Path,
) -> None:
    (tmp_path / "woz_tui").mkdir()
    shutil.copy(ROOT / "woz_tui" / "__init__.py", tmp_path / "woz_tui")
    (tmp_path / "README.md").write_text("![Demo](a.svg) [docs](docs/) [b](https://b.org) [c](#c)\n")
    metadata = {"urls": {"Repository": "https://example.org/woz-tui"}, "readme": {}}
    IndexPage(str(tmp_path), {}).update(metadata)
    at = f"https://example.org/woz-tui/%s/v{__version__}"
    assert metadata["readme"] == {
        "content-type": "text/markdown",
        "text": f"![Demo]({at % 'raw'}/a.svg) [docs]({at % 'blob'}/docs/) "
        f"[b](https://b.org) [c]({at % 'blob'}/README.md#c)\n",
    }


def test_the_sdist_has_what_a_packager_needs(packages: tuple[list[str], Path]) -> None:
    names = set(packages[0])
    wanted = {
        "pyproject.toml",
        "README.md",
        "CONTRIBUTING.md",
        "LICENSE",
        "CHANGELOG.md",
        "Makefile",
    }
    wanted |= {
        "constraints.txt",
        "docs/reference/protocol.md",
        "tests/protocol/golden/messages.jsonl",
    }
    wanted |= {f"experiments/{name}" for name in shipped("experiments")}
    assert wanted <= names


def test_no_recording_leaves_the_house(packages: tuple[list[str], Path]) -> None:
    names, wheel = packages
    everything = [*names, *zipfile.ZipFile(wheel).namelist()]
    private = (PRIVATE, "visitors.json", ".access")
    assert not [name for name in everything if any(what in name for what in private)]


def test_git_commits_no_recording(tmp_path: Path) -> None:
    shutil.copy(ROOT / ".gitignore", tmp_path)
    samples = ["recordings/README.md", "recordings/sample.jsonl", "recordings/sample.samples.jsonl"]
    golden = [
        str(path.relative_to(ROOT))
        for path in (ROOT / "tests" / "log" / "golden").rglob("recordings/*.jsonl")
    ]
    assert golden
    subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    asked = [*LEFT_BEHIND, *samples, *golden]
    ignored = subprocess.run(
        ["git", "-C", str(tmp_path), "check-ignore", "--no-index", *asked],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ignored.stdout.splitlines() == [*LEFT_BEHIND]


# -- the pins -----------------------------------------------------------------------------------


def pins() -> dict[str, str]:
    """Package names and their pinned versions."""
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    pinned = [line for line in lines if line and not line.startswith("#")]
    assert all(re.fullmatch(r"[a-z0-9-]+==[0-9][0-9a-z.]*", line) for line in pinned), pinned
    return dict(line.split("==") for line in pinned)


def requirements() -> list[Requirement]:
    """What the project asks for itself, to run, to develop and to build."""
    project = PROJECT["project"]
    lines = [*project["dependencies"], *project["optional-dependencies"]["dev"]]
    return [Requirement(line) for line in [*lines, *PROJECT["build-system"]["requires"]]]


def needed() -> Iterator[Requirement]:
    """The same and everything that those ask for in turn, as far as it applies here."""
    waiting, seen = requirements(), set()
    while waiting:
        requirement = waiting.pop()
        yield requirement
        if not applies(requirement):
            continue
        for extra in requirement.extras or {""}:
            if (requirement.name, extra) in seen:
                continue
            seen.add((requirement.name, extra))
            further = map(Requirement, distribution(requirement.name).requires or [])
            waiting.extend(line for line in further if applies(line, extra))


def applies(requirement: Requirement, extra: str = "") -> bool:
    """Whether it is asked for on this machine, by this Python; `qi` is not by every one."""
    return requirement.marker is None or requirement.marker.evaluate({"extra": extra})


def test_every_dependency_is_pinned_to_a_version_that_fits() -> None:
    pinned = pins()
    for requirement in needed():
        name = canonicalize_name(requirement.name)
        assert name in pinned, f"{name} has no pin: run `make constraints`"
        assert requirement.specifier.contains(pinned[name], prereleases=True), requirement


def test_nothing_is_pinned_that_nobody_needs() -> None:
    assert set(pins()) == {canonicalize_name(requirement.name) for requirement in needed()}
