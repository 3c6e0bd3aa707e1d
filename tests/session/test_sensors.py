from __future__ import annotations

from pathlib import Path

from tests.session.rig import HERE, NoSettings, SessionRig
from woz_tui.config.experiment import DriverSpec
from woz_tui.config.sensor_names import published_names
from woz_tui.drivers.contract import Offer
from woz_tui.protocol import messages as m


def spec(name: str, *sensors: str) -> DriverSpec:
    return DriverSpec(name, "puppet", NoSettings(), Offer(sensors=sensors), HERE)


def test_a_name_that_one_driver_has_stays_as_it_is() -> None:
    names = published_names([spec("head", "joint.pan"), spec("sonar", "distance")])
    assert names == {"head": {"joint.pan": "joint.pan"}, "sonar": {"distance": "distance"}}


def test_shared_names_say_whose_they_are() -> None:
    two = published_names([spec("left.head", "joint.pan", "load"), spec("right.head", "joint.pan")])
    assert two["left.head"] == {"joint.pan": "left.joint.pan", "load": "load"}
    assert two["right.head"] == {"joint.pan": "right.joint.pan"}
    one = published_names([spec("front", "distance"), spec("back", "distance")])
    assert [one[name]["distance"] for name in one] == ["front.distance", "back.distance"]
    both = published_names([spec("left.a", "distance"), spec("left.b", "distance")])
    assert [both[name]["distance"] for name in both] == ["left.a.distance", "left.b.distance"]


def test_two_robots_do_not_overwrite_each_other(tmp_path: Path) -> None:
    held: list[m.Message] = []

    async def scenario(rig: SessionRig) -> None:
        for name in ("left.robot", "right.robot"):
            context = rig.driver(name).context
            context.reading("distance", 1.0)
            context.sensor("distance", "stale")
        held.extend(rig.session.state.messages())

    SessionRig(tmp_path, ("left.robot", "right.robot")).run(scenario)
    sensed = [line for line in held if isinstance(line, m.Reading | m.SensorChanged)]
    assert [f"{type(line).__name__} {line.sensor}" for line in sensed] == [
        "Reading left.distance",
        "SensorChanged left.distance",
        "Reading right.distance",
        "SensorChanged right.distance",
    ]
