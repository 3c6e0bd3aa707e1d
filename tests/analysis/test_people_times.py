"""For how long how many people were there."""

from __future__ import annotations

from woz_tui.analysis.figures import AddressedRow, PeopleRow
from woz_tui.analysis.people_times import PeopleTimes
from woz_tui.protocol.messages import AddressedChanged, Marker, Reading


def rows(*readings: tuple[float, float | None], sensor: str = "people") -> list[PeopleRow]:
    times = PeopleTimes()
    for seconds, value in readings:
        times.add(Reading(t=round(seconds * 1e6), sensor=sensor, value=value))
        times.add(Reading(t=round(seconds * 1e6), sensor="presence", value=1.0))
    return [*times.rows()]


def test_each_number_of_people_has_its_time() -> None:
    assert rows((0, 0), (1, 1), (2, 2), (3.5, 1), (4, 1)) == [
        PeopleRow("people", 0, 1_000_000),
        PeopleRow("people", 1, 1_500_000),
        PeopleRow("people", 2, 1_500_000),
    ]


def test_time_without_readings_is_nobodys() -> None:
    assert rows((0, 2), (60, 2), (61, None), (65, 2)) == [PeopleRow("people", 2, 3_000_000)]


def test_robots_have_their_own_times_and_other_sensors_none() -> None:
    assert rows((0, 1), (1, 1), sensor="left.people") == [PeopleRow("left.people", 1, 1_000_000)]
    assert rows((0, 1), (1, 1), sensor="people.rate") == []


def test_each_face_has_its_time_by_the_rule_and_by_hand_until_the_log_ends() -> None:
    times = PeopleTimes()
    courses: list[tuple[float, int | None, str]] = [
        *((0, 1, "rule"), (4, 2, "hand"), (5, 2, "rule"), (7, None, "rule"), (9, 1, "rule"))
    ]
    for seconds, face, chosen in courses:
        at = round(seconds * 1e6)
        times.add(AddressedChanged(t=at, driver="eye", face=face, chosen=chosen))
    times.add(Reading(t=5_000_000, driver="eye", sensor="identity.face", value=2.0, text="V3"))
    times.add(Reading(t=6_000_000, driver="eye", sensor="identity.face", value=1.0, text=""))
    times.add(Marker(t=10_000_000, text="end"))
    assert [*times.addressed_rows()] == [
        AddressedRow("eye", 1, "", 5_000_000, 0),
        AddressedRow("eye", 2, "V3", 2_000_000, 1_000_000),
    ]
