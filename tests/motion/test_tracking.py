"""Object tracking in a closed loop: a camera of 20 x 15 pixels on a head that turns to the blob."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass, field

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.motion.chains import eyepi, only
from woz_tui.motion.body_feeds import Sighting
from woz_tui.motion.body_shape import BodyShape, JointShape, Tracking
from woz_tui.motion.kinematics import KinematicChain
from woz_tui.motion.pose_sources import ObjectTracker, TrackingResult
from woz_tui.motion.safety import Safety

DT = 0.02
WIDTH, HEIGHT = 20, 15
FIELD = (60.0, 45.0)
#: Degrees a pixel, in the middle of the picture.
PIXEL = math.degrees(2 * math.tan(math.radians(FIELD[0] / 2)) / WIDTH)


def tracking(shape: BodyShape, **changes: float) -> BodyShape:
    return dataclasses.replace(shape, tracking=Tracking(FIELD, **changes))


@dataclass
class Scene:
    """A head on its tick of 50 Hz, and a camera of 32 Hz whose pictures come `age` seconds late.

    `blob` is the object's direction at a time, in degrees to the left and up; None: hidden.
    """

    shape: BodyShape
    blob: Callable[[float], tuple[float, float] | None]
    age: float = 0.06
    t: float = 0.0
    seen: Sighting | None = None
    pending: list[tuple[float, Sighting]] = field(default_factory=list)
    taken: int = 0

    def __post_init__(self) -> None:
        self.chain = KinematicChain(self.shape)
        self.home = {name: joint.home for name, joint in self.shape.joints.items()}
        self.safety = Safety(self.shape.joints, self.home)
        self.tracker = ObjectTracker(self.shape, self.chain)
        self.tracker.begin(0.0, self.home)

    def off(self) -> tuple[float, float] | None:
        """Pixels from the middle to the blob: to the right, down. None if it is out of view."""
        direction = self.blob(self.t)
        if direction is None:
            return None
        _, gaze = self.chain.ray(self.safety.last)
        yaw, pitch = (math.radians(angle) for angle in direction)
        level = math.cos(pitch)
        to = (level * math.cos(yaw), level * math.sin(yaw), math.sin(pitch))
        flat = math.hypot(gaze[0], gaze[1])
        left = (-gaze[1] / flat, gaze[0] / flat, 0.0)
        up = (-gaze[2] * left[1], gaze[2] * left[0], gaze[0] * left[1] - gaze[1] * left[0])
        ahead = sum(a * b for a, b in zip(gaze, to, strict=True))
        across = sum(a * b for a, b in zip(left, to, strict=True))
        above = sum(a * b for a, b in zip(up, to, strict=True))
        x = -across / ahead / math.tan(math.radians(FIELD[0] / 2)) * WIDTH / 2
        y = -above / ahead / math.tan(math.radians(FIELD[1] / 2)) * HEIGHT / 2
        visible = ahead > 0 and abs(x) <= WIDTH / 2 and abs(y) <= HEIGHT / 2
        return (x, y) if visible else None

    def tick(self) -> TrackingResult:
        self.t += DT
        if self.taken < int(self.t * 32):
            self.taken += 1
            off = self.off()
            # Whole pixels, as a blob of one pixel has them.
            x = None if off is None else round(off[0]) / (WIDTH / 2)
            y = None if off is None else round(off[1]) / (HEIGHT / 2)
            self.pending.append((self.t + self.age, Sighting(0, self.taken, x, y, 0.01)))
        while self.pending and self.pending[0][0] <= self.t:
            self.seen = self.pending.pop(0)[1]
        tracked = self.tracker.step(self.t, self.seen, self.safety.last)
        self.safety.step(tracked.joints, DT)
        return tracked

    def run(self, seconds: float) -> list[TrackingResult]:
        return [self.tick() for _ in range(round(seconds / DT))]


def still(left: float, up: float) -> Callable[[float], tuple[float, float] | None]:
    return lambda _t: (left, up)


def at_home(x: float, y: float) -> tuple[float, float]:
    """The direction of a pixel, counted from the middle, of a head at home: it looks up 9 deg."""
    nine = math.radians(9)
    right = x / (WIDTH / 2) * math.tan(math.radians(FIELD[0] / 2))
    down = y / (HEIGHT / 2) * math.tan(math.radians(FIELD[1] / 2))
    forward = math.cos(nine) + down * math.sin(nine)
    above = math.sin(nine) - down * math.cos(nine)
    pitch = math.atan2(above, math.hypot(forward, right))
    return math.degrees(math.atan2(-right, forward)), math.degrees(pitch)


def hidden(_t: float) -> None:
    return None


@pytest.mark.toolkit("O4")
def test_a_blob_on_the_right_turns_the_head_right() -> None:
    scene = Scene(tracking(eyepi()), still(-5 * PIXEL, 9.0))
    assert scene.off() == pytest.approx((5, 0), abs=0.3)
    scene.run(1.0)
    assert scene.safety.last["pitch"] == pytest.approx(-5 * PIXEL, abs=PIXEL)


@pytest.mark.toolkit("O4")
@given(st.floats(-9.4, 9.4), st.floats(-6.9, 6.9), st.floats(0, 0.12))
def test_a_still_blob_anywhere_in_view_is_centred_without_swinging(
    x: float, y: float, age: float
) -> None:
    scene = Scene(tracking(eyepi()), still(*at_home(x, y)), age)
    assert scene.off() == pytest.approx((x, y), abs=1e-6)
    offs = []
    for _ in range(round(6.0 / DT)):
        scene.tick()
        off = scene.off()
        assert off is not None
        offs.append(off)
    late = offs[round(2.0 / DT) :]
    assert all(abs(value) <= 1 for off in late for value in off)  # pixels
    for axis in (0, 1):  # never more than one pixel past the middle
        first = offs[0][axis]
        assert min(math.copysign(1, first) * off[axis] for off in offs) >= -1
        assert max(off[axis] for off in late) - min(off[axis] for off in late) <= 1


@pytest.mark.toolkit("O4")
@pytest.mark.parametrize("speed", [5.0, -5.0])
def test_a_blob_of_five_pixels_a_second_is_followed(speed: float) -> None:
    scene = Scene(
        tracking(eyepi()), lambda t: (speed * PIXEL * t - 30 * math.copysign(1, speed), 9)
    )
    scene.blob(0)
    offs = []
    for tick in range(round(4.0 / DT)):
        scene.tick()
        off = scene.off()
        if tick * DT > 2:
            assert off is not None
            offs.append(abs(off[0]))
    assert max(offs) <= 2.5  # pixels


@pytest.mark.toolkit("O4", "R6")
def test_a_body_uses_the_roles_it_has() -> None:
    up_only = Scene(tracking(only("top")), still(10.0, 20.0))
    up_only.run(2.0)
    assert up_only.safety.last["pitch"] == 0
    off = up_only.off()
    assert off is not None
    assert abs(off[1]) <= 1
    rigid = Scene(tracking(only()), still(10.0, 9.0))
    assert rigid.run(1.0)[-1].emotion == "happy"
    assert rigid.safety.last == rigid.home


@pytest.mark.toolkit("O4", "R6")
@pytest.mark.parametrize(
    ("axes", "shares"),
    [(("z", "z"), (0.5, 0.5)), (("-z", "z"), (1.0, 1.0)), (("z", "-z"), (0.7, -2.0))],
)
def test_shares_and_axes_of_any_kind_lead_to_the_blob(
    axes: tuple[str, str], shares: tuple[float, float]
) -> None:
    joints = {
        "neck": JointShape(axes[0], -60, 60, 200),
        "head": JointShape(axes[1], -90, 90, 300, offset=(0, 0, 0.1)),
        "nod": JointShape("-y", -40, 40, 300, offset=(0, 0, 0.05)),
    }
    pan = dict(zip(("neck", "head"), shares, strict=True))
    if axes == ("-z", "z"):
        pan["neck"] = 0.25  # pulls the other way, and less
    shape = BodyShape(joints=joints, roles={"pan": pan, "nod": {"nod": 0.5}})
    scene = Scene(tracking(shape), still(25.0, -15.0))
    scene.run(3.0)
    off = scene.off()
    assert off is not None
    assert max(map(abs, off)) <= 1


@pytest.mark.toolkit("O5")
def test_joy_grows_to_one_and_a_short_absence_changes_nothing() -> None:
    scene = Scene(tracking(eyepi()), lambda t: None if t > 6 else (20.0, 9.0))
    moods = scene.run(8.9)
    joy = [one.intensity for one in moods if one.emotion == "happy" and one.intensity is not None]
    assert joy == sorted(joy)
    assert joy[0] <= 0.02
    assert joy[round(4 / DT) :] == [1.0] * len(joy[round(4 / DT) :])
    assert moods[-1].emotion == "happy"


@pytest.mark.toolkit("O5")
def test_moods_by_the_second() -> None:
    scene = Scene(
        tracking(eyepi(), sad_after=2.0, home_after=5.0, happy_in=1.5),
        lambda t: None if 4 < t < 12 else (20.0, 9.0),
        age=0.0,
    )
    at: dict[int, TrackingResult] = {}
    sad: list[float] = []
    for tick in range(1, round(15 / DT)):
        tracked = scene.tick()
        if tick % 50 == 0:
            at[tick // 50] = tracked
        if tracked.emotion == "sad" and tracked.intensity is not None:
            sad.append(tracked.intensity)
    assert [at[second].emotion for second in (1, 3, 5, 7, 8, 10, 13)] == [
        *("happy", "happy", "happy", "sad", "sad", "neutral", "happy")
    ]
    assert sad == sorted(sad)
    assert sad[0] == pytest.approx(0, abs=0.02)
    assert sad[-1] == pytest.approx(1, abs=0.02)
    assert at[10].homing
    assert not at[8].homing
    assert at[11].joints == pytest.approx(scene.home, abs=1)
    assert at[13].intensity == pytest.approx(2 / 3, abs=0.05)  # back for one second
    assert at[14].intensity == 1.0


@pytest.mark.toolkit("O5")
def test_a_lost_frame_changes_nothing() -> None:
    whole, torn = (Scene(tracking(eyepi()), still(9.0, 9.0), age=0.0) for _ in range(2))
    torn.blob = lambda t: None if 0.99 < t < 1.02 else (9.0, 9.0)
    for _ in range(round(3 / DT)):
        one, other = whole.tick(), torn.tick()
        assert (other.emotion, other.intensity, other.homing) == (
            one.emotion,
            one.intensity,
            one.homing,
        )
        assert other.joints == pytest.approx(one.joints, abs=0.5)


@pytest.mark.toolkit("O5")
def test_flicker_is_not_sad() -> None:
    scene = Scene(tracking(eyepi()), lambda t: (9.0, 9.0) if t % 1 < 0.5 else None)
    moods = {one.emotion for one in scene.run(30)}
    assert moods == {"", "happy"}


@pytest.mark.toolkit("O5")
def test_who_never_sees_anything_gets_sad_and_goes_home() -> None:
    scene = Scene(tracking(eyepi()), hidden)
    scene.tracker.begin(0.0, {"pitch": 60.0, "middle": 10.0, "top": 10.0})
    scene.safety.restart({"pitch": 60.0, "middle": 10.0, "top": 10.0})
    moods = scene.run(16)
    assert next(key for key, one in enumerate(moods) if one.emotion == "sad") == 150 - 1
    assert moods[-1].emotion == "neutral"
    assert scene.safety.last == pytest.approx(scene.home, abs=0.5)


def test_a_camera_that_stands_still_shows_nothing_new() -> None:
    scene = Scene(tracking(eyepi()), hidden)
    frozen = Sighting(0, 7, 0.5, 0.0, 0.1)
    moods = [scene.tracker.step(t / 50, frozen, scene.home).emotion for t in range(200)]
    assert moods[0] == "happy"
    assert moods[-1] == "sad"


@given(
    st.lists(
        st.tuples(
            st.floats(-5, 5) | st.sampled_from([math.nan, math.inf, -math.inf]),
            st.none() | st.floats(),
            st.none() | st.floats(),
            st.floats(),
        ),
        max_size=30,
    )
)
def test_whatever_comes_the_pose_is_in_range(
    steps: list[tuple[float, float | None, float | None, float]],
) -> None:
    shape = tracking(eyepi())
    tracker = ObjectTracker(shape, KinematicChain(shape))
    tracker.begin(0.0, {"pitch": math.nan})
    for frame, (t, x, y, angle) in enumerate(steps):
        tracked = tracker.step(t, Sighting(0, frame, x, y), {"pitch": angle, "top": angle})
        assert set(tracked.joints) == set(shape.joints)
        for name, joint in shape.joints.items():
            assert joint.min <= tracked.joints[name] <= joint.max


def test_home_before_sadness_is_a_mistake_in_the_file() -> None:
    shape = tracking(eyepi(), sad_after=5.0, home_after=5.0)
    assert [path for path, _ in shape.problems()] == ["tracking.home_after"]
