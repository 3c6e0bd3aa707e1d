"""A log tells settings; what the command line names stands above them and above the keys."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from woz_tui import cli
from woz_tui.analysis.engagement_rerun import ModelRerun, SettingsOverride
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_json import settings_to_json
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m

SECOND = 1_000_000
QUICK = EngagementSettings(samples=1)


def engagement_adopted(t: int, settings: EngagementSettings | None) -> m.EngagementAdopted:
    return m.EngagementAdopted(t=t, settings={} if settings is None else settings_to_json(settings))


def key(t: int, verb: str, **sent: m.Json) -> list[m.Message]:
    """A key of the wizard's that has been obeyed."""
    name = f"c{t}"
    return [
        m.Command(t=t, command=name, verb=verb, args=sent, driver="engagement", source="key"),
        m.Done(t=t, command=name, sent=sent, latency_us=9, duration_us=9),
    ]


def presence_reading(t: int) -> m.Message:
    return m.Reading(t=t, sensor="presence", value=1.0)


def run_lines(again: ModelRerun, lines: Sequence[m.Message]) -> ModelRerun:
    for line in lines:
        again.apply(line)
    return again


def places(again: ModelRerun) -> int:
    assert again.follower is not None
    return again.follower.shown().signs["presence"].places


def test_there_is_no_model_before_the_log_tells_its_settings_and_none_after_the_last() -> None:
    again = ModelRerun(None, SettingsOverride())
    assert again.apply(presence_reading(0)) == ()
    again.apply(engagement_adopted(SECOND, QUICK))
    [change] = again.apply(presence_reading(SECOND))
    assert (change.now, change.t) == ("PersonDetected", SECOND)
    again.apply(engagement_adopted(2 * SECOND, None))
    assert again.follower is None
    assert again.until(9 * SECOND) == ()
    again.apply(engagement_adopted(9 * SECOND, QUICK))
    assert [change.now for change in again.apply(presence_reading(9 * SECOND))] == [
        "PersonDetected"
    ]


def test_a_model_that_comes_back_knows_what_the_robot_says() -> None:
    """As live, where it is told what holds."""
    say = m.Command(command="c1", verb="say", args={}, driver="voice", source="key")
    spoken = m.Dispatched(command="c1", driver="voice", latency_us=9)
    again = run_lines(
        ModelRerun(None, SettingsOverride()), [say, spoken, engagement_adopted(SECOND, QUICK)]
    )
    assert again.follower is not None
    assert again.follower.speaks


def test_options_stand_above_every_section_that_the_log_tells() -> None:
    again = ModelRerun(None, SettingsOverride(lambda recorded: replace(recorded, samples=5)))
    run_lines(
        again,
        [
            engagement_adopted(0, QUICK),
            engagement_adopted(1, EngagementSettings(social_distance=2.0)),
        ],
    )
    assert places(again) == 5
    assert again.settings.social_distance == 2.0
    assert (
        places(
            run_lines(
                ModelRerun(QUICK, SettingsOverride.always(QUICK)),
                [engagement_adopted(0, EngagementSettings())],
            )
        )
        == 1
    )


def test_settings_that_cannot_be_read_leave_those_that_hold() -> None:
    broken = m.EngagementAdopted(t=1, settings={"samples": "many"})
    again = run_lines(ModelRerun(None, SettingsOverride()), [engagement_adopted(0, QUICK), broken])
    assert places(again) == 1
    assert "samples" in again.unreadable[0]


def test_keys_count_but_for_what_the_command_line_names() -> None:
    keys = [
        *key(1, "filter", sign="all", kind="joint", samples=6),
        *key(2, "filter", sign="all", kind="joint"),
        *key(3, "social_distance", metres=2.0),
    ]
    lines = [engagement_adopted(0, QUICK), *keys]
    engagement_shown = _shown(run_lines(ModelRerun(None, SettingsOverride()), lines))
    assert (engagement_shown.signs["presence"].filter, engagement_shown.social_distance) == (
        "joint",
        2.0,
    )
    again = run_lines(
        ModelRerun(None, SettingsOverride(named={"filter": frozenset({"kind"})})), lines
    )
    engagement_shown = _shown(again)
    assert (
        engagement_shown.signs["presence"].filter,
        engagement_shown.signs["presence"].places,
    ) == ("fifo", 6)
    assert engagement_shown.social_distance == 2.0
    assert again.passed_over == [1, 2]


def _shown(again: ModelRerun) -> m.EngagementShown:
    assert again.follower is not None
    return again.follower.shown()


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """Somebody comes in the fifth second; the wizard has set another filter and distance by then,
    and later the file was edited.
    """
    lines: list[m.Message] = [
        engagement_adopted(0, EngagementSettings()),
        *key(2 * SECOND, "filter", sign="all", samples=1),
        *key(3 * SECOND, "social_distance", metres=2.0),
        *(presence_reading(5 * SECOND + number * SECOND // 3) for number in range(9)),
        engagement_adopted(9 * SECOND, EngagementSettings(farthest=4.0)),
    ]
    path = tmp_path / "2026-03-01T10-00-00_P01_S01.jsonl"
    path.write_bytes(b"".join(map(codec.encode, _numbered(lines))))
    return path


def _numbered(lines: Sequence[m.Message]) -> Iterator[m.Message]:
    for number, line in enumerate(lines):
        yield codec.decode_message(
            json.dumps({**json.loads(codec.encode(line)), "seq": number}).encode()
        )


@pytest.mark.parametrize(
    ("options", "begins", "hint"),
    [
        ([], 5.0, ""),
        (["--samples", "8"], 6.0, "1 change by hand was ignored (at 2.0 s)"),
        (
            ["--samples", "8", "--social-distance", "1"],
            6.0,
            "2 changes by hand were ignored (the first at 2.0 s)",
        ),
        (["--filter", "fifo"], 5.0, ""),
    ],
)
def test_how_many_keys_were_passed_over_is_told(
    log: Path, capsys: pytest.CaptureFixture[str], options: list[str], begins: float, hint: str
) -> None:
    assert cli.main(["engagement", str(log), *options]) == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out.splitlines()[0])["t"] == begins
    assert ("by hand" in captured.err) is bool(hint)
    assert hint in captured.err
    assert "edited" not in captured.err


def test_an_experiment_that_is_named_holds_for_all_of_the_log(
    log: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    guide = Path(__file__).parents[2] / "experiments" / "guide.yaml"
    assert cli.main(["engagement", str(log), "--experiment", str(guide)]) == 0
    assert "edited 9 s after the start" in capsys.readouterr().err
