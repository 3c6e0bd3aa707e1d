"""Faces with the real networks, on pictures that packages bring and others made of them."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from woz_drivers.faces import Faces
from woz_drivers.faces.face_tracks import FaceTracker, distance_of, gaze_of

from tests.drivers.published_messages import PublishedMessages
from tests.peers.face_pictures import (
    CHANGES,
    HEIGHT,
    NOBODY,
    WIDTH,
    FindingProgram,
    RecognisingProgram,
    changed_picture,
    crossing,
    faces_in,
    fitted,
    on_grey,
    open_picture,
    settings,
    whose,
)
from tests.peers.places import place
from woz_tui.drivers.contract import Probe

#: What is too small or too dark for the networks: see docs/explanation/faces.md.
TOO_MUCH = {"blurred by 8 pixels"}


@pytest.fixture(scope="module")
def peer() -> Path:
    return place("faces")


@pytest.fixture(scope="module")
def program(peer: Path) -> Iterator[FindingProgram]:
    with FindingProgram(peer) as ran:
        yield ran


@pytest.mark.parametrize("change", sorted(set(CHANGES) - TOO_MUCH))
def test_one_person_is_one_person(program: FindingProgram, peer: Path, change: str) -> None:
    assert len(program.people(changed_picture(open_picture(peer, "astronaut.png"), change))) == 1


def test_the_run_time_says_nothing_that_could_be_taken_for_a_reason(peer: Path) -> None:
    with FindingProgram(peer) as ran:
        ran.find(on_grey())
    assert ran.errors == b""


@pytest.mark.parametrize("name", NOBODY)
def test_nobody_is_nobody(program: FindingProgram, peer: Path, name: str) -> None:
    picture = fitted(open_picture(peer, name))
    assert program.people(on_grey((picture, WIDTH // 2, HEIGHT // 2))) == []


def test_six_people_in_a_group_are_six(program: FindingProgram, peer: Path) -> None:
    picture = fitted(open_picture(peer, "group.jpg"))
    assert len(program.people(on_grey((picture, WIDTH // 2, HEIGHT // 2)))) == 6


@pytest.mark.parametrize("degrees", [15, 30, -15, -30])
def test_the_roll_follows_a_tilted_head(program: FindingProgram, peer: Path, degrees: int) -> None:
    picture = open_picture(peer, "astronaut.png")
    [upright] = program.find(changed_picture(picture, "as it is")).faces
    [tilted] = program.find(changed_picture(picture, f"tilted by {degrees} degrees")).faces
    assert upright.roll is not None
    assert tilted.roll is not None
    assert tilted.roll - upright.roll == pytest.approx(degrees, abs=3)


def test_half_as_large_is_twice_as_far(program: FindingProgram, peer: Path) -> None:
    picture, focal = open_picture(peer, "astronaut.png"), program.settings.focal
    [whole] = program.find(changed_picture(picture, "as it is")).faces
    [half] = program.find(changed_picture(picture, "at 1/2 of the size")).faces
    ratio = distance_of(half, focal) / distance_of(whole, focal)
    assert ratio == pytest.approx(2, rel=0.1)


def test_a_head_that_is_turned_turns_the_other_way_in_a_mirror(
    program: FindingProgram, peer: Path
) -> None:
    """The third of the group, from the left, looks to the left."""
    picture = open_picture(peer, "group.jpg")
    yaws = []
    for change in ("as it is", "mirrored"):
        faces = program.find(changed_picture(picture, change)).faces
        yaws.append(sorted(gaze[0] for face in faces if (gaze := gaze_of(face)) is not None))
    assert yaws[0][0] < -15
    assert yaws[1][-1] > 15


def test_two_who_cross_keep_their_numbers(program: FindingProgram, peer: Path) -> None:
    tracker = FaceTracker(1.0)
    courses: dict[int, list[float]] = {}
    counts = []
    for n, picture in enumerate(crossing(peer)):
        there = tracker.update(program.find(picture).faces, n * 100_000)
        counts.append(len(there))
        for track in there:
            courses.setdefault(track.id, []).append((track.face.left + track.face.right) / 2)
    assert set(courses) == {1, 2}
    assert set(counts[1:]) == {2}
    assert {course[-1] > course[0] for course in courses.values()} == {True, False}


#: Changes that leave enough of a face to recognise it: see docs/explanation/faces.md.
RECOGNISED = (
    *("mirrored", "tilted by 15 degrees", "tilted by -30 degrees", "at 1/2 of the size"),
    *("at half of the brightness", "at a quarter of the brightness", "blurred by 2 pixels"),
)


def test_people_are_recognised_and_strangers_are_not(
    program: FindingProgram, peer: Path, tmp_path: Path
) -> None:
    """Half of the group is learnt. Nobody gets another's name, whatever the change."""
    group, astronaut = open_picture(peer, "group.jpg"), open_picture(peer, "astronaut.png")
    picture = changed_picture(group, "as it is")
    people = {f"V{n}": face for n, face in enumerate(faces_in(program, picture), 1)}
    assert len(people) == 6
    learnt = ("V1", "V2", "V3")
    with RecognisingProgram(peer, tmp_path) as recogniser:
        for name in learnt:
            assert "refused" not in recogniser.learn(name, picture, people[name])
        assert "V1" in recogniser.learn("V9", picture, people["V1"])["refused"]
        assert "another face" in recogniser.learn("V1", picture, people["V2"])["refused"]
        for change in CHANGES:
            picture = changed_picture(group, change)
            for face in faces_in(program, picture):
                name, _ = recogniser.identify(picture, face)
                owner = whose(face, people, change)
                assert name in ("", owner), change
                assert name == owner or owner not in learnt or change not in RECOGNISED, change
            alone = changed_picture(astronaut, change)
            assert all(recogniser.identify(alone, one)[0] == "" for one in faces_in(program, alone))


async def test_the_driver_with_the_real_program(peer: Path, tmp_path: Path) -> None:
    """From a camera's pictures to readings, and what `woz doctor` says."""
    film = tmp_path / "film"
    picture = np.asarray(changed_picture(open_picture(peer, "astronaut.png"), "as it is")).tobytes()
    film.write_bytes(picture)
    faces_settings = settings(peer, (sys.executable, "-S", "-c", _ENDLESS, str(film)))
    [finding] = await Faces.examine(Probe("it", faces_settings, tmp_path))
    assert "1 face, " in finding.text
    published = PublishedMessages(tmp_path)
    driver = Faces("it", faces_settings, published.context)
    await driver.open()
    try:
        await published.until(lambda: published.values("gaze")[-1:] == [1.0])
    finally:
        await driver.close()
    assert published.values("people")[-1] == 1
    assert published.values("distance")[-1] == pytest.approx(0.9, abs=0.1)


_ENDLESS = """
import sys, time
picture = open(sys.argv[1], "rb").read()
while True:
    sys.stdout.buffer.write(picture)
    sys.stdout.flush()
    time.sleep(1 / 15)
"""
