"""The store of visitors: what may be done, what is refused, and that it survives a restart."""

from __future__ import annotations

import json
from collections.abc import Callable
from datetime import date
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from woz_tui.config.visitor_names import key_of
from woz_tui.sensing import visitor_records as changes
from woz_tui.sensing.visitor_store import Visitor, VisitorRefusedError, VisitorStore, store_at

MONDAY = date(2026, 3, 2)
FRIDAY = date(2026, 3, 6)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "visitors.json"


@pytest.fixture
def store(path: Path) -> VisitorStore:
    return VisitorStore(path)


def names(store: VisitorStore) -> list[str]:
    return [visitor.name for visitor in store.everybody()]


def test_who_was_met_is_known_after_a_restart(path: Path, store: VisitorStore) -> None:
    """A user's name and features survive the program."""
    store.add("Anna", on=MONDAY, age_group="adult", address="Frau", label="face-7")
    store.add("bob", on=MONDAY)
    store.met("ANNA", on=FRIDAY)
    again = VisitorStore(path)
    assert names(again) == ["Anna", "bob"]
    assert again.find("anna") == Visitor(
        "Anna", "adult", "Frau", ("face-7",), "2026-03-02", "2026-03-06", 2
    )
    assert again.called("FACE-7") == again.called("Anna") == again.find("Anna")
    assert again.find("Anna") is not None and again.find("Carla") is None


def test_the_file_is_for_people_and_for_its_owner(path: Path, store: VisitorStore) -> None:
    store.add("Zoë", on=MONDAY, age_group="child")
    assert path.stat().st_mode & 0o777 == 0o600
    assert json.loads(path.read_text("utf-8")) == {
        "format": "woz-tui visitors",
        "version": 1,
        "visitors": [
            {
                "name": "Zoë",
                "age_group": "child",
                "first_met": "2026-03-02",
                "last_met": "2026-03-02",
                "meetings": 1,
            }
        ],
    }
    assert '"name": "Zoë",\n' in path.read_text("utf-8")


def test_the_file_lies_beside_the_logs_unless_it_is_named() -> None:
    assert store_at("", Path("recordings")) == Path("recordings/visitors.json")
    assert store_at("/data/v.json", Path("recordings")) == Path("/data/v.json")


@pytest.mark.parametrize("name", ["Anna", "anna", "ANNA ", "\uff21nna"])
def test_a_name_is_never_given_twice(path: Path, store: VisitorStore, name: str) -> None:
    """An existing name is not overwritten silently."""
    store.add("Anna", on=MONDAY, age_group="adult")
    before = path.read_bytes()
    with pytest.raises(VisitorRefusedError, match="is taken") as error:
        store.add(name, on=FRIDAY)
    assert "rename or forget" in error.value.remedy
    store.add("Bob", on=MONDAY)
    with pytest.raises(VisitorRefusedError, match="is taken"):
        store.rename("Bob", name)
    store.forget("Bob")
    assert path.read_bytes() == before


def test_a_name_that_is_somebodys_face_label_is_taken_too(store: VisitorStore) -> None:
    store.add("Anna", on=MONDAY, label="Anna")
    store.rename("Anna", "A01")
    assert store.is_taken("anna") and store.is_taken("a01") and not store.is_taken("Bob")
    assert store.called("Anna") == store.find("A01")
    with pytest.raises(VisitorRefusedError, match='face label of "A01"'):
        store.add("anna", on=MONDAY)
    store.add("Bob", on=MONDAY)
    for label in ("Anna", "A01"):
        with pytest.raises(VisitorRefusedError, match="is taken"):
            store.learn("Bob", label)
    assert store.learn("Bob", "Bob").labels == ("Bob",)
    assert store.learn("Bob", "bob").labels == ("Bob",)
    assert store.rename("A01", "Anna").labels == ("Anna",)


def test_renaming_keeps_everything_else(store: VisitorStore) -> None:
    store.add("Anna", on=MONDAY, age_group="adult", label="face-7")
    visitor = store.rename("anna", "  A01 ")
    assert visitor == Visitor("A01", "adult", "", ("face-7",), "2026-03-02", "2026-03-02", 1)
    assert names(store) == ["A01"]
    assert store.rename("A01", "a01").name == "a01"


def test_forgetting_leaves_nothing_in_any_file(tmp_path: Path, store: VisitorStore) -> None:
    store.add("Annabella", on=MONDAY, age_group="adult", label="face-7")
    store.add("Bob", on=MONDAY)
    (tmp_path / ".visitors.json.00000000.tmp").write_text("Annabella")
    store.forget("ANNABELLA")
    assert names(store) == ["Bob"]
    for file in tmp_path.iterdir():
        assert b"nnabella" not in file.read_bytes(), file
        assert b"face-7" not in file.read_bytes(), file
    with pytest.raises(VisitorRefusedError, match="no visitor"):
        store.forget("Bob", "Annabella")
    assert names(store) == ["Bob"]
    store.add("Annabella", on=FRIDAY)
    assert store.find("annabella") == Visitor(
        "Annabella", first_met="2026-03-06", last_met="2026-03-06", meetings=1
    )


def test_a_profile_is_filled_in_and_never_silently_changed(store: VisitorStore) -> None:
    store.add("Anna", on=MONDAY, age_group="child")
    assert store.profile("anna", address="du").about == {"age_group": "child", "address": "du"}
    assert store.profile("Anna", age_group="child").age_group == "child"
    with pytest.raises(VisitorRefusedError, match='has age_group "child", not "adult"'):
        store.profile("Anna", age_group="adult", address="Sie")
    assert store.profile("Anna").about == {"age_group": "child", "address": "du"}
    after = store.profile("Anna", age_group="adult", address="", label="face-7", anew=True)
    assert (after.about, after.labels) == ({"age_group": "adult"}, ("face-7",))
    store.add("Bob", on=MONDAY, label="face-8")
    with pytest.raises(VisitorRefusedError, match="is taken"):
        store.profile("Anna", age_group="senior", label="face-8", anew=True)
    assert store.find("Anna") == after


def test_bad_names_and_strangers_are_refused_with_a_remedy(store: VisitorStore) -> None:
    store.add("Anna", on=MONDAY)
    attempts: list[Callable[[], object]] = [
        lambda: store.add("", on=MONDAY),
        lambda: store.add("Unknown", on=MONDAY),
        lambda: store.add("x" * 65, on=MONDAY),
        lambda: store.add("Bob\x1b", on=MONDAY),
        lambda: store.add("Bob", on=MONDAY, age_group="a" * 33),
        lambda: store.add("Bob", on=MONDAY, address="\u202eMr"),
        lambda: store.learn("Anna", ""),
        lambda: store.rename("Anna", "..."),
        lambda: store.rename("Carla", "Dora"),
        lambda: store.met("Carla", on=MONDAY),
        lambda: store.learn("Carla", "face-1"),
        lambda: store.profile("Carla", age_group="adult"),
    ]
    for attempt in attempts:
        with pytest.raises(VisitorRefusedError) as error:
            attempt()
        assert error.value.remedy
    assert names(store) == ["Anna"]


def test_meetings_may_be_noted_late(store: VisitorStore) -> None:
    store.add("Anna", on=FRIDAY)
    visitor = store.met("Anna", on=MONDAY)
    assert (visitor.first_met, visitor.last_met, visitor.meetings) == (
        "2026-03-02",
        "2026-03-06",
        2,
    )
    assert store.add("Bob", on=None) == Visitor("Bob")
    assert store.met("Bob", on=MONDAY) == Visitor("Bob", "", "", (), *2 * ("2026-03-02",), 1)


def test_what_another_process_does_is_seen(path: Path, store: VisitorStore) -> None:
    other = VisitorStore(path)
    assert names(store) == names(other) == []
    other.add("Anna", on=MONDAY)
    assert store.is_taken("anna")
    store.rename("Anna", "A01")
    other.add("Bob", on=MONDAY)
    assert names(store) == names(other) == ["A01", "Bob"]
    path.unlink()
    assert names(store) == []
    store.add("Carla", on=MONDAY)
    assert names(other) == ["Carla"]


NAMES = st.sampled_from(["Anna", "ANNA", "Bob", "C03", "Żaneta", "face-1", "Strasse", "Straße"])
DAYS = st.dates(date(2026, 1, 1), date(2026, 12, 31))
CHANGES = st.one_of(
    st.builds(lambda name: changes.added(Visitor(name)), NAMES),
    st.builds(lambda name, label: changes.added(Visitor(name, labels=(label,))), NAMES, NAMES),
    st.builds(changes.renamed, NAMES, NAMES),
    st.builds(changes.labelled, NAMES, NAMES),
    st.builds(changes.met, NAMES, DAYS),
    st.builds(lambda name: changes.profiled(name, {"age_group": "adult"}, anew=False), NAMES),
    st.builds(changes.forgotten, NAMES),
)


@given(st.lists(CHANGES, max_size=20))
def test_whatever_is_done_names_stay_apart_and_the_file_reads_back(
    made: list[changes.Change],
) -> None:
    people: changes.People = {}
    for change in made:
        before = dict(people)
        try:
            people = change(people)
        except VisitorRefusedError:
            assert people == before
        everything = [{key_of(one.name), *map(key_of, one.labels)} for one in people.values()]
        assert sum(map(len, everything)) == len(set().union(*everything))
        assert all(key == key_of(one.name) for key, one in people.items())
        assert changes.visitors_in(changes.file_text(people), "file") == people
