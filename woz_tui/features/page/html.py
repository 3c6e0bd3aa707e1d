"""The frame of every page, and the pages that say one thing."""

from __future__ import annotations

from importlib.resources import files

from woz_tui.analysis.html.markup import Child, Markup, joined, tag

_ASSETS = files("woz_tui.features.page") / "assets"
#: Files that the server gives to anybody, with their types.
ASSETS = {
    "page.css": "text/css",
    "watch.js": "text/javascript",
    "answer.js": "text/javascript",
    "again.js": "text/javascript",
}


def asset(name: str) -> str:
    """The text of one of our files."""
    return (_ASSETS / name).read_text(encoding="utf-8")


def page(
    title: str,
    *body: Child,
    script: str = "",
    look: str = "",
    language: str = "en",
    again_s: float = 0,
    onward: str = "",
) -> str:
    """A whole page.

    Args:
        title: Its name, for the browser.
        body: What stands on it.
        script: The name of its script; without JavaScript the page is whole, too.
        look: A class of the whole page.
        language: The code of its language, for whoever reads it aloud; empty: nobody knows.
        again_s: Where its script does not run it is loaded again after so many seconds; 0: not.
        onward: An address to which it goes on by itself.
    """
    again = tag("meta", http_equiv="refresh", content=f"{again_s:g}") if again_s else None
    head = tag(
        "head",
        tag("meta", charset="utf-8"),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("title", title),
        tag("link", rel="stylesheet", href="/page.css"),
        tag("noscript", again) if again else None,
        tag("meta", http_equiv="refresh", content=f"0; url={onward}") if onward else None,
        tag("script", src=f"/{script}", defer=True) if script else None,
        tag("script", src="/again.js", defer=True) if script and again_s else None,
    )
    whole = tag("html", head, tag("body", *body, class_=look or None), lang=language or None)
    return f"<!doctype html>\n{whole}"


def say(title: str, *lines: Child, onward: str = "") -> str:
    """A page that says something, and links to where it goes on."""
    link = tag("p", tag("a", "Go on", href=onward, class_="button")) if onward else None
    told = joined(tag("p", line) for line in lines)
    return page(title, tag("main", tag("h1", title), told, link, class_="notice"), onward=onward)


def code_form(complaint: str = "") -> str:
    """Where a class types its code."""
    field = tag(
        "input",
        name="code",
        inputmode="numeric",
        autocomplete="off",
        required=True,
        autofocus=True,
        maxlength=20,
        aria_describedby="complaint" if complaint else None,
    )
    form = tag(
        "form",
        tag("label", tag("span", "Code"), field),
        tag("p", complaint, class_="complaint", id="complaint", role="alert"),
        tag("button", "Watch", type="submit"),
        method="post",
        action="/code",
        autocomplete="off",
    )
    return page("Watch a session", tag("main", tag("h1", "Watch a session"), form, class_="notice"))


def hidden(name: str, value: str) -> Markup:
    """A field of a form that nobody sees."""
    return tag("input", type="hidden", name=name, value=value)
