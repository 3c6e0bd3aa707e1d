"""`woz access`: a file for a name, the list, and taking access away."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from woz_tui import cli
from woz_tui.network.certificates import AccessFile
from woz_tui.remote.access_server import MAY_BE


@pytest.fixture(autouse=True)
def _home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.chdir(tmp_path)


def test_a_name_gets_a_file_stands_in_the_list_and_loses_its_access(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["access", "list"]) == 0
    assert "woz access new" in capsys.readouterr().out
    assert cli.main(["access", "new", "anna", "--address", "robot.local:8765"]) == 0
    capsys.readouterr()
    assert AccessFile.read(tmp_path / "anna.access").address == "robot.local:8765"
    cli.main(["access", "list"])
    assert "anna" in capsys.readouterr().out
    assert cli.main(["access", "revoke", "anna"]) == 0
    cli.main(["access", "list"])
    assert "revoked" in capsys.readouterr().out
    assert cli.main(["access", "revoke", "anna"]) == 1
    assert "anna has no access any more" in capsys.readouterr().err


def test_what_is_told_to_type_is_let_in(capsys: pytest.CaptureFixture[str]) -> None:
    """`woz attach` alone joins as a wizard; drivers have a port of their own."""
    cli.main(["access", "new", "bea"])
    shown = capsys.readouterr().out
    role = re.search(r"\{bea: (\w+)\}", shown)
    assert role is not None
    assert "wizard" in MAY_BE[role[1]]
    assert "woz attach --access bea.access HOST:8765" in shown
    assert shown.rstrip().endswith("--access bea.access HOST:7447")
    cli.main(["access", "new", "carl", "--address", "robot.local:9000"])
    shown = capsys.readouterr().out
    assert "--listen 0.0.0.0:9000" in shown
    assert shown.rstrip().endswith("--access carl.access")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["new", "a b"], "is no name"),
        (["new", "there"], "exists"),
        (["revoke", "nobody"], "nobody was never given access"),
    ],
)
def test_what_cannot_be_done_is_told_and_changes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    (tmp_path / "there.access").write_text("mine")
    assert cli.main(["access", *words]) == 1
    assert told in capsys.readouterr().err
    assert (tmp_path / "there.access").read_text() == "mine"
    assert not (tmp_path / "config" / "woz" / "access" / "names.json").exists()


def test_an_address_without_a_port_is_no_address(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        cli.main(["access", "new", "anna", "--address", "robot"])
    assert "robot.local:8765" in capsys.readouterr().err
    assert not Path("anna.access").exists()
