"""ALTabletService: it really fetches what it shows, so that a wrong address is noticed."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from typing import Any, ClassVar

from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.web import Fetched, fetch
from naoqi_simulator.world import SimulatedWorld

#: Pixels of Pepper's tablet; the signals `onTouch...` but the ratio one count in these.
WIDTH, HEIGHT = 1280, 800
#: How long a video is here when nothing else was set: the stand-in does not decode it.
VIDEO_S = 10.0


class TabletService(Service):
    """The tablet at its chest."""

    name = "ALTabletService"
    signals: ClassVar = {
        **{"onTouch": "(ff)", "onTouchDown": "(ff)", "onTouchDownRatio": "(ffs)"},
        **{"onTouchMove": "(ff)", "onTouchUp": "(ff)", "videoFinished": "()"},
        **{"videoStarted": "()", "onPageStarted": "()", "onPageFinished": "()"},
        **{"onLoadPageError": "(iss)", "onImageLoaded": "()", "onWifiStatusChange": "(s)"},
    }

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__()
        self._world = world
        self._work: set[asyncio.Task[None]] = set()
        self.shows, self.url = "default", ""
        self.page = ""
        self.wifi = "CONNECTED"
        self.brightness = 1.0
        self.video_s = VIDEO_S
        self.fetched: list[Fetched] = []

    @offers("showWebview(s)b")
    def show_webview_of(self, url: str) -> bool:
        """Load an address and show it."""
        return self._show("webview", url)

    @offers("showWebview()b")
    def show_webview(self) -> bool:
        """Show the page that was loaded last."""
        self._change("webview", self.page)
        return True

    @offers("loadUrl(s)b")
    def load_url(self, url: str) -> bool:
        """Load an address without showing it."""
        self.page = url
        self._begin(self._load(url))
        return True

    @offers("reloadPage(b)v")
    def reload_page(self, _past_cache: bool) -> None:
        self.load_url(self.page)

    @offers("hideWebview()b")
    def hide_webview(self) -> bool:
        """The default screen again."""
        self._change("default", "")
        return True

    @offers("cleanWebview()v")
    def clean_webview(self) -> None:
        """Forget the page."""
        self.page = ""

    @offers("showImage(s)b")
    def show_image(self, url: str) -> bool:
        return self._show("image", url)

    @offers("showImageNoCache(s)b")
    def show_image_no_cache(self, url: str) -> bool:
        """As showImage; nothing is cached here."""
        return self._show("image", url)

    @offers("preLoadImage(s)b")
    def pre_load_image(self, url: str) -> bool:
        """Fetch a picture without showing it."""
        self._begin(self._load(url))
        return True

    @offers("hideImage()v")
    def hide_image(self) -> None:
        """The default screen again."""
        self._change("default", "")

    @offers("hide()v")
    def hide(self) -> None:
        """The default screen again, whatever was shown."""
        self._change("default", "")

    @offers("playVideo(s)b")
    def play_video(self, url: str) -> bool:
        """Play a video; `videoFinished` says when it is over."""
        self._change("video", url)
        self._begin(self._play(url))
        return True

    @offers("stopVideo()b")
    def stop_video(self) -> bool:
        """End the video; False when none plays."""
        if self.shows != "video":
            return False
        self._change("default", "")
        return True

    @offers("pauseVideo()b")
    def pause_video(self) -> bool:
        """Pauses are not simulated: False."""
        return False

    @offers("getVideoLength()i")
    def get_video_length(self) -> int:
        """Milliseconds; -1 without a video."""
        return round(self.video_s * 1000) if self.shows == "video" else -1

    @offers("getVideoPosition()i")
    def get_video_position(self) -> int:
        """Milliseconds; -1 without a video."""
        playing = self._world.going.of("video")
        return round((self._world.time.now() - playing[0].begun) * 1000) if playing else -1

    @offers("enableWifi()v")
    def enable_wifi(self) -> None:
        """Switch the tablet's own network on."""
        self._wifi("CONNECTED")

    @offers("disableWifi()v")
    def disable_wifi(self) -> None:
        self._wifi("DISCONNECTED")

    @offers("getWifiStatus()s")
    def get_wifi_status(self) -> str:
        """IDLE, SCANNING, DISCONNECTED or CONNECTED."""
        return self.wifi

    @offers("robotIp()s")
    def robot_ip(self) -> str:
        """The robot's address on the line between tablet and robot: always this one."""
        return "198.18.0.1"

    @offers("setBrightness(f)b")
    def set_brightness(self, level: float) -> bool:
        """0 to 1."""
        if not 0 <= level <= 1:
            raise CallRefusedError(
                "ALTabletService::setBrightness\n\tbrightness must be within [0, 1]"
            )
        self.brightness = level
        return True

    @offers("getBrightness()f")
    def get_brightness(self) -> float:
        """0 to 1."""
        return self.brightness

    @offers("resetTablet()v")
    def reset_tablet(self) -> None:
        """The default screen again."""
        self._change("default", "")

    @offers("turnScreenOn(b)v")
    def turn_screen_on(self, _on: bool) -> None:
        """Not simulated."""

    @offers("wakeUp()v")
    def wake_up(self) -> None:
        """Not simulated: it never sleeps."""

    def touch(self, x: float, y: float) -> None:
        """A finger comes down, moves a pixel, and leaves; shares of the screen."""
        self.emit("onTouchDownRatio", x, y, "")
        for signal in ("onTouch", "onTouchDown", "onTouchMove", "onTouchUp"):
            self.emit(signal, x * WIDTH, y * HEIGHT)

    def let_videos_last(self, seconds: float) -> None:
        """From the next video on."""
        self.video_s = float(seconds)

    def state(self) -> dict[str, Any]:
        """What it shows, and how the last address ended."""
        last = self.fetched[-1] if self.fetched else None
        return {
            **{"shows": self.shows, "url": self.url, "wifi": self.wifi},
            **{"status": last.status if last else 0, "error": last.error if last else ""},
        }

    def _show(self, kind: str, url: str) -> bool:
        self._change(kind, url)
        if kind == "webview":
            self.page = url
        self._begin(self._load(url))
        return True

    def _change(self, shows: str, url: str) -> None:
        self._world.going.end("video")
        self.shows, self.url = shows, url

    def _wifi(self, status: str) -> None:
        if self.wifi != status:
            self.wifi = status
            self.emit("onWifiStatusChange", status)

    async def _load(self, url: str) -> bool:
        self.emit("onPageStarted")
        first = await self._fetch(url)
        if first.error:
            self.emit("onLoadPageError", first.status, first.error, url)
            return False
        for part in first.parts:
            await self._fetch(part)
        self.emit("onPageFinished")
        if first.type.startswith("image/"):
            self.emit("onImageLoaded")
        return True

    async def _fetch(self, url: str) -> Fetched:
        done, _ = await asyncio.to_thread(fetch, url)
        self.fetched.append(done)
        if done.error:
            self._world.note(f"tablet: {url}: {done.error}")
        return done

    async def _play(self, url: str) -> None:
        if not await self._load(url) or self.url != url:
            return
        self.emit("videoStarted")
        if await self._world.going.last("video", self.video_s, url):
            self._change("default", "")
            self.emit("videoFinished")

    def _begin(self, work: Coroutine[Any, Any, Any]) -> None:
        task = asyncio.ensure_future(work)
        self._work.add(task)
        task.add_done_callback(self._work.discard)
