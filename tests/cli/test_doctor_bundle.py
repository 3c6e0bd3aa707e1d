"""`woz doctor --bundle`: it has what a report needs, and nothing that tells who and where."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import pytest

from woz_tui import __version__, cli
from woz_tui.cli.doctor_bundle import Hiding

HIDE = Hiding("/home/ada", "ada", "lab-7")


def test_the_bundle_has_findings_and_versions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("LOGNAME", "ada-lovelace")
    secret = "What is your name, Ada?"
    experiment = tmp_path / "ada-lovelace.yaml"
    experiment.write_text(
        f"title: T\nrobot: simulated\npanels: [{{title: A, actions: [{{label: B, say: '{secret}', "
        "moves: 1}]}]\n"
    )
    bundle = tmp_path / "report.zip"
    words = ["doctor", str(experiment), "--recordings", str(tmp_path), "--bundle", str(bundle)]
    assert cli.main(words) == 1  # the file has an error
    assert "look into it before you send it" in capsys.readouterr().err
    with zipfile.ZipFile(bundle) as archive:
        files = {name: archive.read(name).decode() for name in archive.namelist()}
    assert set(files) == {"README.txt", "doctor.json", "software.json"}
    assert json.loads(files["software.json"])["version"] == __version__
    findings = json.loads(files["doctor.json"])
    assert {"Machine", "Experiment"} <= {each["section"] for each in findings}
    assert [each for each in findings if each["level"] == "error"]
    everything = "".join(files.values())
    for hidden in (str(tmp_path), "ada-lovelace", secret):
        assert hidden not in everything

    before = bundle.read_bytes()
    assert cli.main(words) == 1
    assert "report.zip: File exists" in capsys.readouterr().err
    assert bundle.read_bytes() == before


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("no /home/ada/robot/a.yaml", "no ~/robot/a.yaml"),
        ("ada is not in dialout; adapt it", "USER is not in dialout; adapt it"),
        ("lab-7 and lab-70", "COMPUTER and lab-70"),
        ("ws://pi:secret@192.168.1.7:80/x", "ws://pi:***@ADDRESS:80/x"),
        ("127.0.0.1 and 10.0.0.3 and 0.0.0.0", "127.0.0.1 and ADDRESS and 0.0.0.0"),
        ("fe80::1:2ff:fe33:4455 answers", "ADDRESS answers"),
        ("fe80::1%eth0 and [2001:db8::7]:80", "ADDRESS%eth0 and [ADDRESS]:80"),
        ("mail ada@example.org", "mail MAIL"),
        ("it is 12:30:45, version 1.2.3", "it is 12:30:45, version 1.2.3"),
    ],
)
def test_who_and_where_are_hidden(text: str, shown: str) -> None:
    assert HIDE(text) == shown


def test_names_that_say_nothing_stay() -> None:
    assert Hiding("/", "root", "localhost")("root can open / of localhost") == (
        "root can open / of localhost"
    )
