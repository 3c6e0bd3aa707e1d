"""What a WoZ4U file may say of a setting is what the driver's table says that the robot takes."""

from __future__ import annotations

from woz_drivers.pepper.model import PEPPER

from woz_tui.config.woz4u import pepper_robot


def test_the_robots_ranges_and_words_are_the_drivers() -> None:
    by_file = {one.file: one for one in PEPPER.settings.values() if one.file}
    for ours, choices in pepper_robot._WORDS.values():
        assert by_file.pop(f"autonomy.{ours}").choices == choices
    for ours in pepper_robot._DISTANCES.values():
        assert by_file.pop(f"autonomy.{ours}").range == pepper_robot._METRES
    for ours, allowed in pepper_robot._VOICE.values():
        assert by_file.pop(f"voice.{ours}").range == allowed
    for ours in pepper_robot._FLAGS.values():
        assert by_file.pop(f"autonomy.{ours}").kind == "flag"
    newer = {one for one in by_file if one.startswith(("autonomy.tracking", "autonomy.heeds_"))}
    assert set(by_file) - newer == {"eyes"}
