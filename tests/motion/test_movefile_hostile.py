"""Whatever a move file holds, it is a move that can be played or a list of located problems."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import example, given
from hypothesis import strategies as st

from tests.motion.move_file_bodies import EYEPI
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.move_files import read_folder
from woz_tui.motion.move_schema import move_schema

scalars: st.SearchStrategy[Any] = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-400, 400),
    st.floats(),
    st.sampled_from(["", "nod", "1 2 3", "250 ms", ".nan", "1e999", "smooth", "x\0y", *EMOTIONS]),
)
SCHEMA = move_schema()
NAMES = {
    *SCHEMA["properties"],
    *SCHEMA["properties"]["layers"]["items"]["properties"],
    *SCHEMA["$defs"]["frames"]["items"]["properties"],
}
keys = st.sampled_from([*sorted(NAMES), *EYEPI.joints, "", "y"])
anything = st.recursive(
    scalars, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=4)
)
frames = st.lists(
    st.fixed_dictionaries({"seconds": st.floats(0, 5) | scalars}).flatmap(
        lambda base: st.dictionaries(keys, anything, max_size=4).map(lambda more: more | base)
    )
    | anything,
    max_size=5,
)
layers = st.lists(
    st.fixed_dictionaries(
        {"name": st.sampled_from("abc")},
        optional={
            "frames": frames,
            "rate": st.floats(0.05, 300) | scalars,
            "joints": st.dictionaries(keys, st.lists(st.floats(-100, 100)) | anything, max_size=3),
            "face": anything,
            "share": anything,
            "mix": anything,
        },
    ),
    max_size=3,
)
files = st.fixed_dictionaries(
    {},
    optional={
        **dict.fromkeys(("name", "about", "relative", "beats", "stays"), scalars),
        "frames": frames,
        "layers": layers,
    },
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("moves")


def judged(folder: Path, data: bytes) -> None:
    (folder / "any.yaml").write_bytes(data)
    move_folder = read_folder(folder, EYEPI)
    assert bool(move_folder.moves) != any(not problem.warning for problem in move_folder.problems)
    assert all(problem.place.line >= 1 and problem.message for problem in move_folder.problems)
    for move in move_folder.moves.values():
        assert move.length > 0
        for index in range(-1, 12):
            posture = move.at(move.length * index / 10)
            angles = [*posture.roles.values(), *posture.joints.values(), *posture.places.values()]
            assert all(map(math.isfinite, angles))
            for joint, angle in posture.places.items():
                shape = EYEPI.joints[joint]
                assert shape.min - 1e-9 <= angle <= shape.max + 1e-9


@given(files)
def test_any_mapping(folder: Path, file: dict[str, Any]) -> None:
    judged(folder, yaml.safe_dump(file, allow_unicode=True).encode())


@given(st.binary(max_size=200))
def test_any_bytes(folder: Path, data: bytes) -> None:
    judged(folder, data)


@example(332, 58, b"")  # a key that stands twice
@given(st.integers(0, 2000), st.integers(0, 60), st.binary(max_size=20))
def test_an_example_with_a_piece_torn_out(
    folder: Path, start: int, length: int, instead: bytes
) -> None:
    text = (Path(__file__).parents[2] / "experiments/moves/think.yaml").read_bytes()
    judged(folder, text[:start] + instead + text[start + length :])
