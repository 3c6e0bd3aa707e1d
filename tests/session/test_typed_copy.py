"""Sentences that were typed, in a copy of the experiment file."""

from __future__ import annotations

import resource
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.config.catalogue import CATALOGUE
from tests.config.reading import HEAD, panel
from woz_tui.config.experiment import Action, Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.config.reload_changes import compare
from woz_tui.drivers.contract import Driver
from woz_tui.drivers.plugins import installed
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.typed_actions import (
    ExperimentCopy,
    copy_with_sentences,
    with_sentence,
    with_typed,
    write_beside,
)

EXAMPLES = Path(__file__).parents[2] / "experiments"
TALK = panel("{key: h, label: Hello, say: Hello!}  # first", '{key: "1", label: Bye, say: Bye!}')


def typed_in(experiment: Experiment, texts: Sequence[str]) -> tuple[Action, ...]:
    """As a session makes buttons of them."""
    driver = next(d.name for d in experiment.drivers if any(v.name == "say" for v in d.offer.verbs))
    typed: tuple[Action, ...] = ()
    for text in texts:
        typed = with_sentence(with_typed(experiment, typed), typed, text, driver)
    return typed


def copy_of(
    path: Path, *texts: str, catalogue: dict[str, type[Driver]] | None = None
) -> tuple[ExperimentCopy, Experiment]:
    """The copy, written, and what is read from it."""
    catalogue = catalogue or dict(CATALOGUE)
    typed = typed_in(load(path, catalogue), texts)
    copy = write_beside(path, copy_with_sentences(path, typed, partial(load, path, catalogue)))
    assert copy.file.read_bytes() == copy.data
    return copy, load(copy.file, catalogue)


def file(folder: Path, text: str, name: str = "talk.yaml") -> Path:
    path = folder / name
    path.write_bytes(text.encode())
    return path


def said_texts(experiment: Experiment) -> list[object]:
    panel = next(panel for panel in experiment.panels if panel.title == "Typed")
    return [call.args["text"] for action in panel.actions for call in action.calls]


def test_lines_go_in_and_nothing_else_changes(tmp_path: Path) -> None:
    path = file(tmp_path, TALK + "\n# the end\nscript: [Hello]   # one line\n")
    copy, read = copy_of(path, "One moment", 'Say "a: b" # {participant}')
    assert copy.file == tmp_path / "talk-typed.yaml"
    block = (
        "  - title: Typed\n"
        "    actions:\n"
        '      - {key: "2", label: "One moment", say: "One moment"}\n'
        '      - {key: "3", label: "Say \\"a: b\\" # {participant}",'
        ' say: "Say \\"a: b\\" # {participant}"}\n'
    )
    assert copy.file.read_text() == TALK + block + "\n# the end\nscript: [Hello]   # one line\n"
    assert copy.diff[:2] == ("--- talk.yaml", "+++ talk-typed.yaml")
    assert [line[1:] + "\n" for line in copy.diff[3:]] == block.splitlines(keepends=True)
    assert said_texts(read) == ["One moment", 'Say "a: b" # {participant}']
    assert path.read_text() == TALK + "\n# the end\nscript: [Hello]   # one line\n"


FORMS = {
    "no line end": TALK.rstrip("\n"),
    "windows": TALK.replace("\n", "\r\n"),
    "byte order mark": "\ufeff" + TALK,
    "comments of the panel": TALK + "      # - {key: z, label: Z, say: Z}\n\nscript: [Hello]\n",
    "in brackets": HEAD + "panels: [{title: P, actions: [{key: h, label: Hello, say: Hello!}]}]\n",
    "a comma at the end": HEAD
    + "panels: [\n  {title: P, actions: [{key: h, label: Hello, say: Hello!}]},  # so\n]\n",
    "not indented": HEAD + "panels:\n- title: P\n  actions:\n  - {label: Hello, say: Hello!}\n#x\n",
    "a long text last": HEAD
    + "panels:\n  - title: P\n    actions:\n      - label: Hello\n        say: |\n"
    "          Hello\n          # no comment\n\n\nscript: [Hello]\n",
    "an own panel": TALK + "  - title: Typed\n    actions:\n      - {label: Old, say: Old}\n"
    "  - title: Z\n    actions:\n      - {label: Z, say: Z}\n",
    "an own panel in brackets": TALK + "  - {title: Typed, actions: [{label: Old, say: Old}]}\n",
    "an own panel that is empty": TALK + "  - {title: Typed, actions: []}\n",
    "blank lines": TALK + "\n  # second\n  - title: Z\n    actions:\n      - {label: Z, say: Z}\n",
}


@pytest.mark.parametrize("form", FORMS)
def test_every_way_to_write_a_file_keeps_its_bytes(tmp_path: Path, form: str) -> None:
    path = file(tmp_path, FORMS[form])
    copy, read = copy_of(path, "One moment")
    assert said_texts(read)[-1] == "One moment"
    old, new = path.read_bytes(), copy.data
    at = next((at for at, byte in enumerate(old) if new[at] != byte), len(old))
    assert new.endswith(old[at:])
    assert (b"\r\n" in new) is (b"\r\n" in old)
    assert new.count(b"\n") - new.count(b"\r\n") in (new.count(b"\n"), 0)
    base = load(path, CATALOGUE)
    changes = compare(base, read).changes
    assert all("is new" in change for change in changes), changes


@pytest.mark.parametrize("name", ["demo", "guide", "interview", "study", "two-robots", "pepper"])
def test_the_examples_take_typed_sentences(tmp_path: Path, name: str) -> None:
    path = EXAMPLES / f"{name}.yaml"
    catalogue = dict(installed())
    read = partial(load, path, catalogue)
    copy = copy_with_sentences(
        path, typed_in(read(None), ["Hello", "Just a second: {participant}"]), read
    )
    assert copy.sentences == 2
    assert said_texts(read(copy.data))[-1] == "Just a second: {participant}"


# A single brace is refused when it is typed, and a NUL cannot be.
LETTERS = st.characters(codec="utf-8", exclude_characters="\0{}")
PIECES = st.sampled_from(["{{", "}}", "{participant}", ": ", " #", '"', "'", "\\", "- "])
TEXTS = st.lists(LETTERS | PIECES, min_size=1, max_size=60).map("".join).filter(str.strip)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(texts=st.lists(TEXTS, min_size=1, max_size=5, unique=True))
def test_any_typed_texts_survive(tmp_path: Path, texts: list[str]) -> None:
    path = file(tmp_path, TALK)
    read = partial(load, path, CATALOGUE)
    copy = copy_with_sentences(path, typed_in(read(), texts), read)
    assert said_texts(read(copy.data)) == texts


def test_a_name_that_the_file_has_is_not_taken_twice(tmp_path: Path) -> None:
    _, read = copy_of(file(tmp_path, TALK), "Hello", "Hello there")
    actions = read.panels[-1].actions
    assert [action.label for action in actions] == ["Hello", "Hello there"]
    assert actions[0].name != "Hello"


def test_a_copy_takes_no_name_that_exists(tmp_path: Path) -> None:
    path = file(tmp_path, TALK)
    names = [copy_of(path, "One moment")[0].file.name for _ in range(3)]
    assert names == ["talk-typed.yaml", "talk-typed-2.yaml", "talk-typed-3.yaml"]
    again, read = copy_of(tmp_path / names[1], "Another one")
    assert again.file.name == "talk-typed-4.yaml"
    assert said_texts(read) == ["One moment", "Another one"]


def test_what_the_file_has_is_not_added_again(tmp_path: Path) -> None:
    path = file(tmp_path, TALK)
    typed = typed_in(load(path, CATALOGUE), ["One moment"])
    copy, _ = copy_of(path, "One moment")
    assert copy_with_sentences(copy.file, typed, partial(load, copy.file, CATALOGUE)).sentences == 0


def test_a_key_that_the_file_has_by_now_is_not_given_twice(tmp_path: Path) -> None:
    path = file(tmp_path, TALK)
    typed = typed_in(load(path, CATALOGUE), ["One moment"])
    assert typed[0].key == "2"
    file(tmp_path, TALK + '      - {key: "2", label: Later, say: Later}\n')
    read = partial(load, path, CATALOGUE)
    assert read(copy_with_sentences(path, typed, read).data).panels[-1].actions[0].key == "3"


def test_a_file_with_errors_or_without_a_place_is_refused(tmp_path: Path) -> None:
    path = file(tmp_path, TALK)
    read = partial(load, path, CATALOGUE)
    typed = typed_in(read(), ["One moment"])
    file(tmp_path, TALK + "scripts: [Hello]\n")
    with pytest.raises(ExperimentError):
        copy_with_sentences(path, typed, read)
    shared = TALK.replace("actions:", "actions: &a") + "  - {title: Typed, actions: *a}\n"
    file(tmp_path, shared)
    with pytest.raises((RequestError, ExperimentError)):
        copy_with_sentences(path, typed, read)
    path.unlink()
    with pytest.raises(RequestError, match=r"talk\.yaml cannot be read"):
        copy_with_sentences(path, typed, read)
    assert [*tmp_path.iterdir()] == []


def test_a_woz4u_file_has_no_place_for_them(tmp_path: Path) -> None:
    path = EXAMPLES / "woz4u" / "config.yaml"
    read = partial(load, path, dict(installed()))
    with pytest.raises(RequestError, match="no list of panels"):
        copy_with_sentences(path, typed_in(read(None), ["One moment"]), read)


def test_a_disk_that_takes_no_more_leaves_no_half_file(tmp_path: Path) -> None:
    path = file(tmp_path, TALK)
    read = partial(load, path, CATALOGUE)
    copy = copy_with_sentences(path, typed_in(read(), ["One moment"]), read)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (64, hard))
    try:
        with pytest.raises(RequestError, match="no copy could be written"):
            write_beside(path, copy)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert [*tmp_path.iterdir()] == [path]


def test_a_folder_that_takes_no_file_is_named(tmp_path: Path) -> None:
    path = file(tmp_path, TALK)
    read = partial(load, path, CATALOGUE)
    copy = copy_with_sentences(path, typed_in(read(), ["One moment"]), read)
    with pytest.raises(RequestError, match="no copy could be written to /proc"):
        write_beside(Path("/proc/talk.yaml"), copy)
