"""The page for watchers as HTML; `assets/watch.js` keeps it new, place by place."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from woz_tui.analysis.html.markup import Markup, isolated, tag
from woz_tui.features.page.html import page
from woz_tui.features.page.watch_view import View

#: Seconds after which a browser without JavaScript loads the page again.
_AGAIN_S = 3


def watch_page(view: View, *, big: bool = False, cameras: Sequence[str] = ()) -> str:
    """The page as it is at this moment; `big`: for a projector; with pictures of these cameras."""
    told = [_place("p", view, name) for name in ("trial", "phase", "plays")]
    now = tag("p", tag("time", view["time"], id="time"), " ", tag("span", "of the session"))
    head = tag("header", _place("h1", view, "title"), tag("div", told, now, class_="told"))
    other = ("/watch", "Normal size") if big else ("/watch?big", "Large, for a projector")
    return page(
        view["title"],
        head,
        _place("div", view, "stop", role="alert"),
        _place("div", view, "lost", role="alert"),
        tag(
            "p",
            tag("a", "The report of this session", href="/watch/debrief", class_="button"),
            id="debrief",
            hidden=not view["debrief"],
        ),
        tag(
            "main",
            tag(
                "section",
                tag("h2", "Now"),
                _place("p", view, "engagement", aria_live="polite"),
                tag("ul", map(_meter, view["meters"]), id="meters"),
                [
                    tag("img", src=f"/watch/picture/{place}", alt=f"Picture of {camera}")
                    for place, camera in enumerate(cameras)
                ],
                aria_label="Now",
            ),
            tag(
                "section",
                tag("h2", "What happened, newest first"),
                tag("ol", map(_event, view["events"]), id="events"),
                aria_label="What happened, newest first",
            ),
        ),
        tag("footer", tag("a", other[1], href=other[0])),
        script="watch.js",
        look="watch big" if big else "watch",
        again_s=_AGAIN_S,
    )


def _place(name: str, view: View, place: str, **attributes: Any) -> Markup:
    """An element with a text that the script replaces; hidden while it is empty."""
    return tag(name, view[place], id=place, hidden=not view[place], **attributes)


def _event(event: dict[str, Any]) -> Markup:
    return tag(
        "li",
        tag("time", event["when"]),
        tag("span", event["sign"], class_="sign", aria_hidden="true"),
        tag("span", event["kind"], class_="unseen"),
        tag("p", [tag("span", isolated(text), class_=look) for text, look in event["pieces"]]),
        class_=event["look"],
    )


def _meter(meter: dict[str, Any]) -> Markup:
    share = meter["share"]
    bar = tag("meter", value=f"{share:.2f}", aria_hidden="true") if share is not None else None
    return tag(
        "li",
        tag("span", meter["name"], class_="name"),
        tag("span", bar),
        tag("span", meter["text"], class_="value"),
        class_="old" if meter["old"] else None,
    )
