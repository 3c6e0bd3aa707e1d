"""The session's view of the store of visitors, on which others work too and disks fill up."""

from __future__ import annotations

import asyncio
import stat
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import date
from pathlib import Path

import pytest

from tests.session.engagement_rig import PLAIN, EngagementRig, guided, in_room
from woz_tui.protocol import messages as m
from woz_tui.sensing.visitor_store import VisitorStore
from woz_tui.session import known_visitors
from woz_tui.session.known_visitors import KnownVisitors, StoreJob

TODAY = date(2026, 3, 2)


class VisitorsRig:
    """Acquaintances whose reports are heard when `hear` is called; what they published."""

    def __init__(self, path: Path) -> None:
        self.lines: list[m.Message] = []
        self._calls: list[Callable[[], object]] = []
        self.known = KnownVisitors(path, self.lines.append, self._calls.append)
        self.known.read()

    def finish(self, seconds: float = 20) -> None:
        """The session ends."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(known_visitors, "_AT_ONCE_S", 20.0)  # a disk is not slow here
            asyncio.run(self.known.finish(seconds))

    def hear(self) -> None:
        """All changes have been tried, and this is heard."""
        self.known.wait(20)
        while self._calls:
            self._calls.pop(0)()

    @property
    def notices(self) -> list[str]:
        return [line.text for line in self.lines if isinstance(line, m.Notice)]

    @property
    def changes(self) -> list[tuple[str, str]]:
        changed = [line for line in self.lines if isinstance(line, m.VisitorChanged)]
        return [(line.visitor, line.what) for line in changed]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    folder = tmp_path / "store"
    folder.mkdir()
    return folder / "visitors.json"


@pytest.fixture
def refusing(path: Path) -> Iterator[Path]:
    """Its place takes no lock file: a folder stands where it would be."""
    lock = path.parent / ".visitors.json.lock"
    lock.unlink(missing_ok=True)
    lock.mkdir()
    yield lock


def names(path: Path) -> list[str]:
    return [visitor.name for visitor in VisitorStore(path).everybody()]


def test_whom_others_forget_or_rename_is_so_here_too_without_a_change_of_our_own(
    path: Path,
) -> None:
    other = VisitorStore(path)
    for name in ("Anna", "Bob", "Cy"):
        other.add(name, on=TODAY)
    rig = VisitorsRig(path)
    rig.known.meet("Anna", TODAY)
    rig.hear()
    other.forget("Anna")
    other.rename("Bob", "B01")
    other.add("Dora", on=None, label="face-9")
    rig.known.refresh()
    rig.hear()
    assert not rig.known.is_taken("Anna") and not rig.known.is_taken("Bob")
    assert rig.known.is_taken("b01") and rig.known.is_taken("Cy")
    dora = rig.known.called("face-9")
    assert dora is not None and dora.name == "Dora"
    assert rig.changes == [("Anna", "met"), ("Anna", "forgotten")]
    assert not rig.notices


def test_a_name_that_is_not_in_the_file_yet_is_known_nevertheless(path: Path) -> None:
    """What is known is replaced as a whole while two introductions wait for the disk."""
    rig = VisitorsRig(path)
    rig.known.introduce("Anna", {}, TODAY)
    rig.known.left()
    rig.known.introduce("Bob", {"age_group": "child"}, TODAY)
    assert rig.known.is_taken("anna") and rig.known.is_taken("bob")
    rig.hear()
    assert rig.known.is_taken("anna") and rig.known.is_taken("bob")
    assert names(path) == ["Anna", "Bob"]
    assert rig.known.lacks == 0


def test_what_the_disk_refused_is_saved_at_the_end(path: Path, refusing: Path) -> None:
    rig = VisitorsRig(path)
    rig.known.introduce("Anna", {}, TODAY)
    rig.hear()
    rig.known.left()
    rig.known.introduce("Bob", {}, TODAY)
    rig.hear()
    assert len(rig.notices) == 1 and "cannot be written" in rig.notices[0]
    assert rig.known.lacks == 2
    refusing.rmdir()
    rig.finish()
    assert names(path) == ["Anna", "Bob"]
    assert len(rig.notices) == 1


def test_a_refusal_that_nobody_has_heard_of_yet_is_tried_again_at_the_end(
    path: Path, refusing: Path
) -> None:
    rig = VisitorsRig(path)
    rig.known.introduce("Anna", {}, TODAY)
    rig.known.wait(20)
    refusing.rmdir()
    rig.finish()
    assert names(path) == ["Anna"]


def test_what_is_lost_with_the_session_is_told(path: Path, refusing: Path) -> None:
    rig = VisitorsRig(path)
    rig.known.introduce("Anna", {}, TODAY)
    rig.finish()
    first, last = rig.notices
    assert "cannot be written" in first
    assert last == f"visitors: 1 change of this session could not be saved in {path}"
    assert not path.exists()


def test_a_new_visitor_is_an_occasion_to_save_what_the_disk_refused(
    path: Path, refusing: Path
) -> None:
    rig = VisitorsRig(path)
    rig.known.introduce("Anna", {}, TODAY)
    rig.hear()
    refusing.rmdir()
    rig.known.refresh()
    rig.hear()
    assert (names(path), rig.known.lacks) == (["Anna"], 0)


def test_what_was_given_up_is_told_once(path: Path, refusing: Path) -> None:
    rig = VisitorsRig(path)
    rig.known.introduce("Anna", {}, TODAY)
    rig.hear()
    refusing.rmdir()
    VisitorStore(path).add("anna", on=TODAY, age_group="adult")
    rig.known.refresh()
    rig.hear()
    rig.known.refresh()
    rig.hear()
    (told,) = [text for text in rig.notices if "given up" in text]
    assert "anna" in told
    anna = rig.known.called("Anna")
    assert anna is not None and anna.about == {"age_group": "adult"}


def test_names_given_while_the_file_is_damaged_go_into_the_mended_one(path: Path) -> None:
    path.write_text("{ this is no store")
    rig = VisitorsRig(path)
    rig.known.introduce("Anna", {}, TODAY)
    rig.hear()
    rig.known.refresh()
    rig.hear()
    assert rig.known.is_taken("Anna")
    assert rig.known.lacks == 1
    assert len(rig.notices) == 1
    path.unlink()
    VisitorStore(path).add("Bob", on=TODAY)
    rig.known.refresh()
    rig.hear()
    assert names(path) == ["Anna", "Bob"]
    assert rig.known.is_taken("Anna") and rig.known.is_taken("Bob")
    assert rig.known.lacks == 0


def test_a_session_hears_of_others_changes_when_somebody_comes(tmp_path: Path) -> None:
    """Renamed and forgotten by `woz visitors` meanwhile, and nobody was introduced in between."""
    store = VisitorStore(tmp_path / "recordings" / "visitors.json")
    store.path.parent.mkdir()
    store.add("Anna", on=TODAY)

    async def scenario(rig: EngagementRig) -> None:
        model = rig.session.engagement._model
        assert model is not None
        visiting = model.visitors
        assert visiting.visitors.is_taken("Anna")
        store.rename("Anna", "V12")
        await rig.visit(3)
        visiting.visitors.wait(20)
        await asyncio.sleep(0.5)
        assert not visiting.visitors.is_taken("Anna")
        assert visiting.visitors.is_taken("V12")

    in_room(tmp_path, scenario)


def test_a_session_saves_at_its_end_what_a_full_disk_refused(tmp_path: Path) -> None:
    lock = tmp_path / "people" / ".visitors.json.lock"
    lock.mkdir(parents=True)
    path = lock.with_name("visitors.json")
    rig = session_with_anna(tmp_path, path, lock.rmdir)
    assert names(path) == ["Anna"]
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert not [text for text in rig.notices if "could not be saved" in text]


def test_the_log_has_what_was_lost_before_its_last_line(tmp_path: Path) -> None:
    lock = tmp_path / "people" / ".visitors.json.lock"
    lock.mkdir(parents=True)
    rig = session_with_anna(tmp_path, lock.with_name("visitors.json"), lambda: None)
    (told,) = [i for i, line in enumerate(rig.lines) if "could not be saved" in str(line)]
    assert isinstance(rig.lines[-1], m.SessionEnd)
    assert told < len(rig.lines) - 1


def session_with_anna(
    tmp_path: Path, path: Path, before_the_end: Callable[[], object]
) -> EngagementRig:
    """A session in which Anna was introduced, with a store at `path`."""

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("visitor", code="Anna")
        await asyncio.sleep(0.5)
        model = rig.session.engagement._model
        assert model is not None
        visiting = model.visitors
        visiting.visitors.wait(20)
        await asyncio.sleep(0.5)
        assert any("cannot be written" in text for text in rig.notices)
        before_the_end()

    return in_room(tmp_path, scenario, guided(tmp_path, replace(PLAIN, visitors=str(path))))


def hanging(known: KnownVisitors) -> threading.Event:
    """From here on a change waits for the disk until the event is set."""
    gate = threading.Event()

    def hang(store: VisitorStore) -> None:
        gate.wait(20)

    known._do(StoreJob(hang, "Anna"))
    return gate


def test_a_disk_that_hangs_at_the_end_does_not_hold_up_the_event_loop(tmp_path: Path) -> None:
    """What lets the disk go on here is the loop itself."""

    async def scenario() -> EngagementRig:
        rig = EngagementRig(tmp_path, guided(tmp_path))
        async with rig:
            model = rig.session.engagement._model
            assert model is not None
            gate = hanging(model.visitors.visitors)

            def hear(message: m.Message) -> None:
                if isinstance(message, m.Notice) and "within 2.5 s" in message.text:
                    asyncio.get_running_loop().call_soon(gate.set)

            rig.session.hub.listen(hear)
        gate.set()
        return rig

    rig = asyncio.run(scenario())
    assert [text for text in rig.notices if "does not respond" in text]
    assert not [text for text in rig.notices if "could not be saved" in text]
    assert isinstance(rig.lines[-1], m.SessionEnd)


def test_a_disk_that_hangs_for_good_is_left_and_told_of(path: Path) -> None:
    rig = VisitorsRig(path)
    gate = hanging(rig.known)
    rig.finish(0.05)
    gate.set()
    assert rig.notices == [f"visitors: 1 change of this session could not be saved in {path}"]
    rig.known.wait(20)
