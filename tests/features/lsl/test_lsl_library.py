"""Where the library is missing, the message names it and where it comes from: no traceback."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.features.lsl.laboratory import needs_library
from woz_tui.cli import main
from woz_tui.features.lsl.doctor import CHECKS

#: As pip installs it on 64-bit Arm.
WITHOUT_LIBRARY = 'raise RuntimeError("LSL binary library file was not found. Please make sure ")'


def woz(*arguments: str, path: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "woz_tui", *arguments],
        env={**os.environ, "PYTHONPATH": str(path)},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


@pytest.fixture
def armed(tmp_path: Path) -> Path:
    """A folder with a pylsl that has no library."""
    (tmp_path / "pylsl.py").write_text(WITHOUT_LIBRARY)
    return tmp_path


def test_a_pylsl_without_its_library_is_told_with_what_helps(armed: Path) -> None:
    ended = woz("lsl", "S99", path=armed)
    assert ended.returncode == 1
    assert ended.stderr.startswith("woz: pylsl has no library liblsl on this computer")
    assert "labrecorder" in ended.stderr and "PYLSL_LIB=" in ended.stderr
    assert "Traceback" not in ended.stderr


def test_the_doctor_tells_it_too(armed: Path) -> None:
    found = woz("doctor", "--recordings", str(armed), path=armed).stdout
    words = " ".join(found.split())
    assert "pylsl has no library liblsl" in words


def test_the_package_is_named_where_there_is_none(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "pylsl", None)
    assert main(["lsl"]) == 1
    assert "`woz lsl` needs the package pylsl" in capsys.readouterr().err
    (finding,) = CHECKS.examine()
    assert (finding.level, "woz-tui[lsl]" in finding.remedy) == ("info", True)


@needs_library
def test_the_doctor_says_which_versions_there_are() -> None:
    (finding,) = CHECKS.examine()
    assert (finding.level, finding.text[:6]) == ("ok", "pylsl ")
