"""`woz report --verify` finds a set of proposals that did not end exactly once."""

from __future__ import annotations

from pathlib import Path

from tests.log.recorder_rig import recorder_rig
from woz_tui.features.proposals.kinds import (
    ProposedItem,
    SuggestGone,
    SuggestOffered,
    SuggestTaken,
)
from woz_tui.log.verify import verify
from woz_tui.protocol import messages as m


def test_each_set_ends_exactly_once(tmp_path: Path) -> None:
    with recorder_rig(tmp_path) as rig:
        for name in ("taken", "gone", "open", "twice"):
            items = [ProposedItem("1", text="Hello")]
            rig.hub.publish(SuggestOffered(set=name, source="program", items=items))
        for name in ("taken", "twice"):
            rig.hub.publish(SuggestTaken(set=name, item="1", how="key"))
        for name in ("gone", "twice", "never"):
            rig.hub.publish(SuggestGone(set=name, how="expired"))
        rig.hub.publish(m.SessionEnd(reason="wizard", sha256=rig.recorder.digest()[0]))
        rig.recorder.close()
        found = verify(rig.recorder.path, places=[rig.home, rig.spill])
    assert (found.unended, found.ended_twice, found.unasked) == (["open"], ["twice"], ["never"])
