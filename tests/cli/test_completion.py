"""What a shell completes of `woz`; that the files are of today is in tests/test_docs.py."""

from __future__ import annotations

import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from woz_tui import cli
from woz_tui.cli import completion


def printed(shell: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert cli.main(["completion", shell]) == 0
    return capsys.readouterr().out


def completed(script: str, folder: Path, *words: str) -> set[str]:
    """What bash offers for the last of these words."""
    ask = (
        f"{script}\nCOMP_WORDS=({shlex.join(words)}); COMP_CWORD={len(words) - 1}\n"
        '_shtab_woz; printf "%s\\n" "${COMPREPLY[@]}"'
    )
    done = subprocess.run(
        ["bash", "-c", ask], cwd=folder, capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stderr == ""
    return {word.strip() for word in done.stdout.splitlines() if word.strip()}


def test_bash_completes_commands_options_choices_and_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script = printed("bash", capsys)
    (tmp_path / "guide.yaml").touch()
    (tmp_path / "games").mkdir()
    assert completed(script, tmp_path, "woz", "rep") == {"report", "replay"}
    assert completed(script, tmp_path, "woz", "pag") == {"page"}  # of a feature
    assert completed(script, tmp_path, "woz", "run", "--part") == {"--participant"}
    assert completed(script, tmp_path, "woz", "access", "re") == {"revoke"}
    assert completed(script, tmp_path, "woz", "new", "x.yaml", "--template", "mus") == {"museum"}
    assert completed(script, tmp_path, "woz", "run", "g") >= {"guide.yaml", "games"}
    assert completed(script, tmp_path, "woz", "run", "--recordings", "ga") == {"games"}
    # A robot's name, a pattern or a dash would do, too.
    assert completed(script, tmp_path, "woz", "report", "g") >= {"guide.yaml", "games"}
    assert completed(script, tmp_path, "woz", "check", "x", "--robot", "g") >= {"guide.yaml"}


@pytest.mark.parametrize("shell", completion.SHELLS)
def test_each_shell_reads_its_file_without_an_error(
    shell: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script = printed(shell, capsys)
    assert "record-move" in script
    if shutil.which(shell) is not None:
        (tmp_path / "script").write_text(script)
        subprocess.run([shell, "-n", str(tmp_path / "script")], check=True, timeout=60)


def test_a_shell_that_is_not_known_is_told_which_are(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        cli.main(["completion", "bsh"])
    assert "did you mean 'bash'?" in capsys.readouterr().err
