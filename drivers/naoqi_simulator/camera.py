"""ALVideoDevice."""

from __future__ import annotations

import asyncio
import math
from dataclasses import dataclass
from typing import Any

from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.visitor import HALF_ACROSS, HALF_UPRIGHT, SimulatedPerson
from naoqi_simulator.world import SimulatedWorld

#: Width and height by NAOqi's number of a resolution.
RESOLUTIONS = {
    **{8: (40, 30), 7: (80, 60), 0: (160, 120), 1: (320, 240), 2: (640, 480), 3: (1280, 960)},
}
RGB, BGR, GREY = 11, 13, 0
_LAYERS = {RGB: 3, BGR: 3, GREY: 1}
#: How far a NAO's lower camera looks down, in radians (family/nao_technical/video_naov6).
LOWER_TURN = math.radians(39.7)
#: How often the same name may be subscribed, as the documentation says.
_MOST = 6


@dataclass(frozen=True, slots=True)
class _Subscription:
    camera: int
    resolution: int
    space: int
    fps: int


class VideoDevice(Service):
    """The cameras: both see the same here, but that a NAO's lower one looks down to its feet."""

    name = "ALVideoDevice"

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__()
        self._world = world
        self._subscriptions: dict[str, _Subscription] = {}

    @offers("subscribe(siii)s")
    def subscribe(self, name: str, resolution: int, space: int, fps: int) -> str:
        """The upper camera; the name under which pictures are had."""
        return self.subscribe_camera(name, 0, resolution, space, fps)

    @offers("subscribeCamera(siiii)s")
    def subscribe_camera(
        self, name: str, camera: int, resolution: int, space: int, fps: int
    ) -> str:
        """Camera 0 or 1; resolutions 0, 1, 2, 3, 7, 8; colours 11 (RGB), 13 (BGR), 0 (grey)."""
        method = "ALVideoDevice::subscribeCamera"
        if camera not in (0, 1):
            raise CallRefusedError(f"{method}\n\tinvalid camera index {camera}")
        if resolution not in RESOLUTIONS or space not in _LAYERS:
            raise CallRefusedError(
                f"{method}\n\tinvalid resolution {resolution} or color space {space}"
            )
        if not 1 <= fps <= 30:
            raise CallRefusedError(f"{method}\n\tinvalid frame rate {fps}")
        for number in range(_MOST):
            handle = f"{name}_{number}"
            if handle not in self._subscriptions:
                self._subscriptions[handle] = _Subscription(camera, resolution, space, fps)
                return handle
        raise CallRefusedError(f"{method}\n\t{name} is subscribed {_MOST} times already")

    @offers("unsubscribe(s)b")
    def unsubscribe(self, handle: str) -> bool:
        """False for a name that is not subscribed."""
        return self._subscriptions.pop(handle, None) is not None

    @offers("unsubscribeAllInstances(s)b")
    def unsubscribe_all_instances(self, name: str) -> bool:
        """All handles of a name; False when there is none."""
        handles = [one for one in self._subscriptions if one.rpartition("_")[0] == name]
        for handle in handles:
            del self._subscriptions[handle]
        return bool(handles)

    @offers("getSubscribers()[s]")
    def get_subscribers(self) -> list[str]:
        return list(self._subscriptions)

    @offers("getImageRemote(s)m", typed="(iiiiiiriffff)")
    async def get_image_remote(self, handle: str) -> list[Any]:
        """A picture: width, height, layers, colours, seconds, microseconds, bytes, camera, and the
        camera's angles (rad) to the left, the top, the right, the bottom.
        """
        held = self._subscriptions.get(handle)
        if held is None:
            raise CallRefusedError(f"ALVideoDevice::getImageRemote\n\t{handle} is not subscribed")
        width, height = RESOLUTIONS[held.resolution]
        body, now = self._world.body, self._world.time.now()
        down = LOWER_TURN if held.camera == 1 and body.plan.walks else 0.0
        look = body.angle("HeadYaw"), body.angle("HeadPitch") + down
        # In a thread: a large picture takes longer than anybody else should wait.
        picture = await asyncio.to_thread(
            _drawn, width, height, held.space, self._world.person(), look
        )
        return [
            *(width, height, _LAYERS[held.space], held.space),
            *(int(now), int(now % 1 * 1e6), picture, held.camera),
            *(HALF_ACROSS, HALF_UPRIGHT, -HALF_ACROSS, -HALF_UPRIGHT),
        ]

    @offers("releaseImage(s)b")
    def release_image(self, handle: str) -> bool:
        """Nothing is held here."""
        return handle in self._subscriptions

    @offers("getActiveCamera()i")
    def get_active_camera(self) -> int:
        """The upper one."""
        return 0


def _drawn(
    width: int, height: int, space: int, person: SimulatedPerson | None, look: tuple[float, float]
) -> bytes:
    """What is seen with the head at yaw and pitch (rad): a byte a layer of each pixel, by rows."""
    from naoqi_simulator import scene  # noqa: PLC0415 - with numpy: most robots are not watched

    picture = scene.draw(width, height, person, *look)
    if space == BGR:
        picture = picture[:, :, ::-1]
    elif space == GREY:
        picture = picture.mean(axis=2).astype("uint8")
    return picture.tobytes()
