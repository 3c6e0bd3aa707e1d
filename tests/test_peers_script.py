"""`.ci/peers`, with peers that install nothing and a stand-in for pytest."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BEGIN = "# -- installing and running"


class Checkout:
    """A folder with the script and peers of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.places = folder / ".venv" / "peers"
        (folder / ".ci").mkdir()
        self._write(".venv/bin/python", '#!/bin/bash\necho "python $*"\nexit ${TESTS:-0}\n')

    def _write(self, name: str, text: str) -> None:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)

    def run(self, peers: str, *options: str, **environment: str) -> tuple[int, str]:
        script = (ROOT / ".ci" / "peers").read_text()
        head, _, body = script.partition("# -- the peers --")
        self._write(".ci/peers", f"{head}\n{peers}\n{BEGIN}{body.partition(BEGIN)[2]}")
        done = subprocess.run(
            [self.folder / ".ci" / "peers", *options],
            env={"PATH": os.environ["PATH"], **environment},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=60,
            check=False,
        )
        return done.returncode, done.stdout


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    return Checkout(tmp_path)


LAMP = """
peer_red_lamp() {
  : a lamp\\'s daemon
  echo ran >>"$root/ran"
  touch daemon
}
"""
MISSING = """
peer_sound() {
  : a server of sounds
  echo loading
  cannot "it is for other computers"
}
peer_crash() {
  : something broken
  echo "no such wheel" >&2
  false
}
peer_source() {
  : something that nobody packs
  source_of bridge
  ln -s "$source" bridge
}
"""
SLOW = """
peer_slow() {
  : something slow
  sleep 60
}
"""

BUILT = """
peer_model() {
  : something that takes minutes to build
  mkdir bin
  printf '#!/bin/sh\\necho "$WHEEL"\\n' >bin/python
  chmod +x bin/python
  built_before model 1.0
  echo "${built:-built now}" >how
}
"""


def test_a_peer_is_installed_once_and_again_when_its_function_changes(checkout: Checkout) -> None:
    for text, installations in (
        (LAMP, 1),
        (LAMP, 1),
        (LAMP.replace("touch daemon", "touch other"), 2),
    ):
        code, shown = checkout.run(text, "-k", "goto")
        assert code == 0
        assert "python -m pytest -m peers " in shown
        assert " tests/peers -k goto" in shown
        assert "red-lamp: a lamp's daemon" in shown
        assert (checkout.folder / "ran").read_text().split() == ["ran"] * installations
    assert (checkout.places / "red-lamp" / "other").exists()
    assert not (checkout.places / "red-lamp" / "daemon").exists()


def test_all_are_installed_without_a_test(checkout: Checkout) -> None:
    code, shown = checkout.run(LAMP + MISSING, "--install")
    assert code == 0
    assert "pytest" not in shown
    assert (checkout.places / "red-lamp" / "daemon").exists()
    code, shown = checkout.run(LAMP + MISSING)
    assert "Installing red-lamp" not in shown, "it is there"
    assert "python -m pytest" in shown


def test_what_cannot_be_had_is_named_with_the_reason(checkout: Checkout) -> None:
    code, shown = checkout.run(LAMP + MISSING)
    assert code == 0
    _, _, missing = shown.partition("left out: 3\n")
    reasons = dict(line.strip().split(": ", 1) for line in missing.splitlines())
    assert "it is for other computers" in reasons["sound"]
    assert "no such wheel" in reasons["crash"]
    assert "PEERS_DIR" in reasons["source"]
    assert not list(checkout.places.glob("s*/.installed"))


def test_an_installation_that_hangs_is_ended(checkout: Checkout) -> None:
    code, shown = checkout.run(SLOW, PEER_SECONDS="1")
    assert code == 0
    assert "slow: cannot be had: the installations have taken 1 s" in shown


def test_a_source_that_no_registry_has_comes_from_a_folder(
    checkout: Checkout, tmp_path: Path
) -> None:
    (tmp_path / "sources" / "bridge").mkdir(parents=True)
    code, shown = checkout.run(MISSING, PEERS_DIR=str(tmp_path / "sources"))
    assert code == 0
    assert (checkout.places / "source" / "bridge").is_dir()
    assert "source: something that nobody packs" in shown


@pytest.mark.parametrize(("tests", "code"), [("0", 0), ("1", 1), ("5", 0)])
def test_it_fails_when_a_test_fails(checkout: Checkout, tests: str, code: int) -> None:
    assert checkout.run(LAMP, TESTS=tests)[0] == code


def test_what_takes_minutes_to_build_is_built_only_by_its_name(checkout: Checkout) -> None:
    how = checkout.places / "model" / "how"
    code, shown = checkout.run(BUILT)
    assert code == 0
    assert "takes minutes to build; once: .ci/peers --install model" in shown
    assert checkout.run(BUILT, WHEEL="/kept/model.whl")[0] == 0
    assert how.read_text() == "/kept/model.whl\n"
    assert checkout.run(BUILT, "--install", "model")[0] == 0
    assert how.read_text() == "built now\n"
