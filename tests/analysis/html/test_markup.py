"""Text that becomes markup only where it was meant to."""

from __future__ import annotations

import json
from html.parser import HTMLParser

from hypothesis import given
from hypothesis import strategies as st

from woz_tui.analysis.html.markup import clean, escaped, isolated, joined, json_block, short, tag
from woz_tui.analysis.text_format import digits

#: All of Unicode, halves of pairs too, and what is special in HTML more often than by chance.
TEXTS = st.text(st.characters() | st.sampled_from("<>&\"'/!-\0\u2028\u202e\ud800"))


class Seen(HTMLParser):
    """What a reader of HTML makes of it."""

    def __init__(self, markup: str) -> None:
        super().__init__(convert_charrefs=True)
        self.tags: list[str] = []
        self.attributes: dict[str, str | None] = {}
        self.text = ""
        self.feed(markup)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes.update(attrs)

    def handle_data(self, data: str) -> None:
        self.text += data


@given(TEXTS)
def test_any_text_comes_back_as_text(text: str) -> None:
    seen = Seen(tag("p", text, title=text))
    assert seen.tags == ["p"]
    assert seen.text == clean(text)
    assert seen.attributes == {"title": clean(text)}


@given(TEXTS)
def test_any_text_can_be_written_to_a_file(text: str) -> None:
    assert joined(isolated(text), escaped(text)).encode("utf-8")


@given(st.dictionaries(TEXTS, TEXTS))
def test_any_data_come_back_and_never_end_their_element(data: dict[str, str]) -> None:
    block = json_block(data, "data")
    inner = block.removeprefix('<script type="application/json" id="data">')
    inner = inner.removesuffix("</script>")
    assert "<" not in inner
    assert "\u2028" not in inner
    read = json.loads(inner)
    halves = any("\ud800" <= one <= "\udfff" for pair in data.items() for one in "".join(pair))
    assert halves or read == data


def test_attributes_are_named_as_in_html() -> None:
    markup = tag("td", class_="x", data_number=7, hidden=True, id=None, open=False)
    assert markup == '<td class="x" data-number="7" hidden></td>'
    assert tag("br") == "<br>"


def test_children_may_be_nested_and_absent() -> None:
    markup = tag("p", "a", None, ["b", (tag("i", "c"), None)], (word for word in "de"))
    assert markup == "<p>ab<i>c</i>de</p>"


def test_numbers_in_pictures_are_short() -> None:
    assert [short(one) for one in (1, 1.04, 1.06, -0.5, 10.0)] == ["1", "1", "1.1", "-0.5", "10"]


def test_figures_have_three_digits_that_count_and_no_exponent() -> None:
    found = [digits(one) for one in (0.0, 0.06512, 16.12, 962.4, 999.6, 1217.3, 84_000.2)]
    assert found == ["0.00", "0.0651", "16.1", "962", "1000", "1217", "84000"]
