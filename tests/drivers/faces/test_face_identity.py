"""Who has consented is recognised: by the real program and its store, with a stand-in for the
network alone.
"""

from __future__ import annotations

import base64
import json
import re
import sys
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from woz_drivers.camera.raw_pictures import PictureLayout
from woz_drivers.faces import Faces
from woz_drivers.faces.face_geometry import CROP_PLACES, CROP_SIDE, crop_of
from woz_drivers.faces.face_identity import TrackIdentity
from woz_drivers.faces.face_networks import PictureSampler
from woz_drivers.faces.settings import FacesSettings

from tests.drivers.faces.faces_rig import FacesRig
from tests.drivers.published_messages import until
from tests.fakes import face_program, face_recogniser_program
from tests.fakes.face_program import face
from tests.fakes.face_recogniser_program import FALLS_OVER
from tests.session.rig import SessionRig
from woz_tui.cli import main
from woz_tui.config.loading import load
from woz_tui.drivers.contract import DriverError, Probe, RejectedError
from woz_tui.drivers.face_store import FaceStore, default_path
from woz_tui.drivers.plugins import installed
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Notice, Reading
from woz_tui.system.clock import RealClock

pytestmark = pytest.mark.safety

PIXELS = 96
SIZE = 3 * PIXELS * PIXELS
FINDER = (sys.executable, "-S", face_program.__file__, str(SIZE))
RECOGNISER = (sys.executable, "-m", face_recogniser_program.__name__)
ANNA, BELA, CLEO = (2, 20, 66, 40), (2, 20, 66, 120), (66, 20, 30, 200)
Person = tuple[int, int, int, int]


def shot(*people: Person) -> bytes:
    """A picture with these people in it: left, top, side of the face and its grey."""
    pixels = np.zeros((PIXELS, PIXELS, 3), np.uint8)
    for left, top, side, grey in people:
        pixels[top : top + side, left : left + side] = grey
    heads = b"".join(face(*one[:3]) for one in people)
    return heads + pixels.tobytes()[len(heads) :]


class IdentityRig(FacesRig):
    """A driver that recognises people."""

    def __init__(self, folder: Path, **settings: Any) -> None:
        given = {"recogniser": RECOGNISER, "identity": True, **settings}
        super().__init__(folder, width=PIXELS, height=PIXELS, program=FINDER, **given)

    @property
    def name(self) -> str | None:
        """What the last reading of `identity` says; None: there was none."""
        told = [one.text for one in self.published.all(Reading) if one.sensor == "identity"]
        return told[-1] if told else None

    @property
    def names(self) -> set[tuple[float | None, str]]:
        """Each face's number with each name that it has had; empty for a stranger."""
        told = [one for one in self.published.all(Reading) if one.sensor == "identity.face"]
        return {(one.value, one.text) for one in told}

    async def see(self, *people: Person, until: Callable[[], bool]) -> None:
        """Show these people until something holds."""
        for _ in range(2000):
            if until():
                return
            await self.look(*people)
        raise AssertionError(f"it never was so; the last name was {self.name!r}")

    async def look(self, *people: Person) -> None:
        """One picture."""
        before = self.answers
        self.pipe.send(shot(*people))
        await until(lambda: self.answers > before)
        self.clock.advance(0.1)

    async def learn(self, name: str, *people: Person, consent: bool = True) -> Any:
        """The wizard's two keys, while these people are there."""
        count = len(people)
        await self.see(
            *people, until=lambda: self.name is not None and self.last("people") == count
        )
        if consent:
            await (await self.perform("face_consent", name=name, given=True))
        task = await self.perform("learn_face", name=name)
        await self.see(*people, until=task.done)
        return await task


@pytest.fixture
async def rig(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[IdentityRig]:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    identity_rig = IdentityRig(tmp_path)
    await identity_rig.driver.open()
    await until(identity_rig.pipe.connected)
    yield identity_rig
    await identity_rig.driver.close()


def test_nobody_is_recognised_unless_the_robot_file_says_so() -> None:
    quiet, faces_settings = FacesSettings(), FacesSettings(identity=True)
    verbs = [{verb.name for verb in Faces.offer(one).verbs} for one in (quiet, faces_settings)]
    assert verbs[1] - verbs[0] == {"face_consent", "learn_face"}
    sensors = [set(Faces.offer(one).sensors) for one in (quiet, faces_settings)]
    assert sensors[1] - sensors[0] == {"identity", "identity.face"}


async def test_without_consent_nothing_is_written(rig: IdentityRig) -> None:
    with pytest.raises(RejectedError, match="V3") as caught:
        await rig.learn("V3", ANNA, consent=False)
    assert "face_consent" in caught.value.remedy
    assert not default_path().exists()
    assert rig.name == "", "a stranger"


async def test_who_consented_and_was_learnt_is_recognised_and_nobody_else(
    rig: IdentityRig,
) -> None:
    await rig.learn("V3", ANNA)
    await rig.see(ANNA, until=lambda: rig.name == "V3")
    assert rig.last("identity") == pytest.approx(1, abs=0.01)
    assert {one.text for one in rig.published.all(Reading) if one.sensor == "identity.face"} == {
        "",
        "V3",
    }
    assert default_path().stat().st_mode & 0o777 == 0o600
    [kept_face] = FaceStore(default_path()).faces()
    assert (kept_face.name, kept_face.log) == (
        "V3",
        rig.published.context.media.name.removesuffix(".media"),
    )
    for _ in range(15):  # the face is gone
        await rig.look()
    await rig.see(BELA, until=lambda: rig.last("addressed") == 2)
    await rig.see(BELA, until=lambda: rig.name == "")


async def test_of_two_people_the_addressed_one_is_learnt_and_both_get_their_names(
    rig: IdentityRig,
) -> None:
    await rig.learn("V3", ANNA, CLEO)
    await rig.see(ANNA, CLEO, until=lambda: rig.names >= {(1.0, "V3"), (2.0, "")})


async def test_a_consent_is_good_for_one_learning(rig: IdentityRig) -> None:
    await rig.learn("V3", ANNA)
    with pytest.raises(RejectedError):
        await rig.learn("V3", ANNA, consent=False)


async def test_a_name_that_another_face_has_is_refused_and_so_is_a_second_name(
    rig: IdentityRig,
) -> None:
    await rig.learn("V3", ANNA)
    before = default_path().read_bytes()
    with pytest.raises(DriverError, match="V3"):
        await rig.learn("V9", ANNA)
    for _ in range(15):
        await rig.look()
    with pytest.raises(DriverError, match="another face"):
        await rig.learn("v3", BELA)
    assert default_path().read_bytes() == before


async def test_a_face_too_far_away_is_not_learnt(
    rig: IdentityRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("woz_drivers.faces.face_identity._PATIENCE_S", 0.2)
    with pytest.raises(DriverError, match="not seen well") as caught:
        await rig.learn("V3", CLEO)
    assert "one metre" in caught.value.remedy
    assert not default_path().exists()


async def test_a_consent_that_is_withdrawn_deletes_what_was_kept(rig: IdentityRig) -> None:
    await rig.learn("V3", ANNA)
    await rig.see(ANNA, until=lambda: rig.name == "V3")
    told = await (await rig.perform("face_consent", name="v3", given=False))
    assert told["deleted"] is True
    assert FaceStore(default_path()).faces() == []
    await rig.look(ANNA)
    assert rig.name == ""


async def test_a_consent_withdrawn_while_a_face_is_learnt_keeps_nothing(
    rig: IdentityRig,
) -> None:
    await rig.see(ANNA, until=lambda: rig.name is not None and rig.last("people") == 1)
    await (await rig.perform("face_consent", name="V3", given=True))
    learning = await rig.perform("learn_face", name="V3")
    await rig.look(ANNA)
    await (await rig.perform("face_consent", name="V3", given=False))
    await rig.see(ANNA, until=learning.done)
    with pytest.raises(RejectedError, match="withdrawn"):
        await learning
    assert FaceStore(default_path()).faces() == []


async def test_a_consent_can_be_withdrawn_where_the_recogniser_does_not_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    FaceStore(default_path()).learn("V3", b"template", "2026-03-01", "log")
    identity_rig = IdentityRig(tmp_path, recogniser="", models=str(tmp_path / "none"))
    await identity_rig.driver.open()
    try:
        await until(identity_rig.pipe.connected)
        told = await (await identity_rig.perform("face_consent", name="V3", given=False))
    finally:
        await identity_rig.driver.close()
    assert told["deleted"] is True
    assert FaceStore(default_path()).faces() == []


async def test_woz_visitors_forget_reaches_a_session_that_runs(
    rig: IdentityRig, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    await rig.learn("V3", ANNA)
    await rig.see(ANNA, until=lambda: rig.name == "V3")
    file = ("--file", str(tmp_path / "v.json"))
    assert main(["visitors", "list", "--json", *file]) == 0
    assert json.loads(capsys.readouterr().out)["faces"] == ["V3"]
    assert main(["visitors", "forget", "v3", "--yes", *file]) == 0, "no visitor of that name"
    assert "V3" in capsys.readouterr().out
    assert b"V3" not in default_path().read_bytes()
    await rig.see(ANNA, until=lambda: rig.name == "")


@pytest.mark.parametrize("words", [["V4"], ["--all"]])
def test_a_visitor_with_another_name_is_forgotten_with_the_face(
    words: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    FaceStore(default_path()).learn("V3", b"template", "2026-03-01", "log")
    file = ("--file", str(tmp_path / "v.json"))
    assert main(["visitors", "add", "V3", *file]) == 0
    assert main(["visitors", "rename", "V3", "V4", *file]) == 0
    capsys.readouterr()
    assert main(["visitors", "forget", *words, "--yes", "--json", *file]) == 0
    assert json.loads(capsys.readouterr().out) == {"forgotten": ["V4"], "faces": ["V3"]}
    assert FaceStore(default_path()).faces() == []


async def test_a_recogniser_that_falls_over_costs_names_and_nothing_else(
    rig: IdentityRig,
) -> None:
    await rig.see(ANNA, until=lambda: rig.name == "")
    for _ in range(15):
        await rig.look()
    falling = (2, 20, 66, FALLS_OVER + 5)
    await rig.see(falling, until=lambda: rig.published.states("identity")[-1] == "stale")
    assert rig.published.states("gaze") == ["ok"]
    assert any("out of memory" in one.text for one in rig.published.all(Notice))
    await rig.see(ANNA, until=lambda: rig.published.states("identity")[-1] == "ok")


async def test_the_doctor_says_how_many_faces_are_kept(rig: IdentityRig, tmp_path: Path) -> None:
    (tmp_path / "film").write_bytes(shot(ANNA) * 30)
    faces_settings = FacesSettings(
        command=f"cat {tmp_path / 'film'}",
        width=PIXELS,
        height=PIXELS,
        format="rgb24",
        program=FINDER,
        identity=True,
        recogniser=RECOGNISER,
    )
    _, finding = await Faces.examine(Probe("it", faces_settings, tmp_path))
    assert (finding.level, "no face" in finding.text) == ("ok", True)
    missing = FacesSettings(
        command=f"cat {tmp_path / 'film'}", program=FINDER, identity=True, models=str(tmp_path)
    )
    finding = (await Faces.examine(Probe("it", missing, tmp_path)))[-1]
    assert finding.level == "error"


def test_a_name_counts_once_it_was_the_answer_twice_in_a_row() -> None:
    known = TrackIdentity()
    answers = ("V3", "V9", "V9", "", "V9", "V9", "", "")
    assert [name for name in answers if known.answered(name, 0.5, 0)] == ["V9", ""]
    assert known.name == ""


@pytest.mark.parametrize("factor", [0.5, 1.0 + 0.7j, -2.0j])
def test_a_crop_has_the_face_upright_whatever_its_size_and_tilt(factor: complex) -> None:
    """A picture whose red and green say where a pixel of the crop must come from."""
    layout = PictureLayout(640, 480, "rgb24", 3 * 640)
    x, y = np.meshgrid(np.arange(640), np.arange(480))
    at = (x + 1j * y - (300 + 240j)) / factor + 56 * (1 + 1j)
    picture = np.zeros((480, 640, 3), np.uint8)
    picture[..., 0], picture[..., 1] = np.clip(at.real * 2, 0, 255), np.clip(at.imag * 2, 0, 255)
    sampler = PictureSampler(layout)
    sampler.load(picture.tobytes())
    places = [(complex(*one) - 56 * (1 + 1j)) * factor + (300 + 240j) for one in CROP_PLACES]
    crop = crop_of(sampler, [(one.real, one.imag) for one in places])
    found = (
        np.frombuffer(crop, np.uint8).reshape(CROP_SIDE, CROP_SIDE, 3)[20:92, 20:92].astype(float)
        / 2
    )
    wanted = np.arange(20, 92)
    assert np.abs(found[..., 0] - wanted[None, :]).max() < 3
    assert np.abs(found[..., 1] - wanted[:, None]).max() < 3


# -- what must never leave the store ---------------------------------------------------------------


@pytest.mark.parametrize("damage", ["{", '{"format": "x", "version": 1, "faces": []}', "[]"])
def test_a_file_that_is_not_ours_is_left_as_it_is(damage: str, tmp_path: Path) -> None:
    path = tmp_path / "faces.json"
    path.write_text(damage)
    with pytest.raises(DriverError, match=r"faces\.json"):
        FaceStore(path).learn("V3", b"template", "2026-03-01", "log")
    assert path.read_text() == damage


async def test_no_template_is_in_any_byte_of_a_session_or_of_what_is_made_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither as it is stored, nor as the numbers themselves, binary or written out."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    folder = tmp_path / "lab"
    folder.mkdir()
    (folder / "film").write_bytes(shot(ANNA))
    (folder / "study.yaml").write_text(_STUDY)
    experiment = load(folder / "study.yaml", installed())
    rig = SessionRig(folder, catalogue=installed(), made=experiment, clock=RealClock())
    async with rig:
        await rig.until(lambda: any(_is_identity(one, "") for one in rig.lines))
        rig.session.play("Consents", RequestOrigin("key", "c", "con1"))
        await rig.until(lambda: any(_is_identity(one, "V3") for one in rig.lines))
    recordings = str(folder / "recordings")
    for form in ("csv", "bids", "eaf", "textgrid"):
        options = ["--samples"] if form in ("csv", "bids") else []
        assert (
            main(["export", recordings, "--to", form, "--out", str(folder / form), *options]) == 0
        )
    assert main(["report", recordings, "--html", str(folder / "report.html")]) == 0
    [kept_face] = FaceStore(default_path()).faces()
    everything = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    assert any(b"face_consent" in data and b"V3" in data for data in everything.values())
    for template in kept_face.templates:
        numbers = np.frombuffer(template, "<f4")
        traces = re.compile(
            b"|".join(map(re.escape, (base64.b64encode(template)[:20], template[:20])))
            + b"|"
            + _in_a_row(numbers)
        )
        assert traces.search(json.dumps(numbers[:9].round(4).tolist()).encode())
        assert traces.search(default_path().read_bytes()), "it is found where it is"
        assert [path.name for path, data in everything.items() if traces.search(data)] == []


def _in_a_row(numbers: Any) -> bytes:
    """A pattern for any three of them, written out one after the other with three digits or more.
    The third may have been rounded.
    """
    written = [rf"0?\.{f'{abs(number):.6f}'[2:4]}\d+" for number in numbers]
    rows = zip(written, written[1:], written[2:], strict=False)
    return "|".join(r"[^\d.]{1,4}".join(row) for row in rows).encode()


def _is_identity(message: m.Message, name: str) -> bool:
    return isinstance(message, Reading) and message.sensor == "identity" and message.text == name


_ENDLESS = """
import sys, time
picture = open("film", "rb").read()
while True:
    sys.stdout.buffer.write(picture)
    sys.stdout.flush()
    time.sleep(0.05)
"""
_STUDY = f"""
title: Faces
robot:
  name: it
  drivers:
    eye:
      type: faces
      command: {json.dumps([sys.executable, "-S", "-c", _ENDLESS])}
      program: {json.dumps(FINDER)}
      recogniser: {json.dumps(RECOGNISER)}
      width: {PIXELS}
      height: {PIXELS}
      format: rgb24
      identity: true
panels:
  - title: Faces
    actions:
      - key: c
        label: Consents
        steps: [{{face_consent: V3}}, {{learn_face: V3}}]
"""
