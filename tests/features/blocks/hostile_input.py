"""Blocks and frames that are as wrong as a seed makes them, from slightly to wholly."""

from __future__ import annotations

from random import Random
from xml.sax.saxutils import quoteattr

from woz_tui.features.blocks.bml_block import NAMESPACE, REQUIRED_ATTRIBUTES, SYNC_POINTS

NUMBERS = (
    *("0", "1", "-1", "0.5", "-0", "1e3", "86400", "86401", "1e308", "1e400", "-1e400", "nan"),
    *("NaN", "inf", "-inf", "1_0", "0x10", "9" * 400, "0." + "0" * 400 + "1", "\u0663", "1,5", ""),
)
WORDS = (
    *(
        "NOD",
        "BEAT",
        "SMILE",
        "left",
        "20, -5",
        "9" * 400 + " 1",
        "nan, nan",
        "SITTING",
        "x" * 5000,
    ),
    *("\u202e", "{0}", "{{", "%s", "../..", "\n\t", "id", "start", "a:b:c:d", ":", "+", "\u00e4"),
)
COMPOSITIONS = (
    *("MERGE", "APPEND", "REPLACE", "append", "APPEND-AFTER(b0)", "APPEND-AFTER()", "SOON", ""),
    "APPEND-AFTER(" + "b " * 2000 + ")",
)
HEADS = (
    "",
    '<?xml version="1.0" encoding="{}"?>',
    '<!DOCTYPE bml [<!ENTITY a "{}"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>',
    '<!DOCTYPE bml SYSTEM "file:///etc/passwd">',
    "<!-- {} -->",
)
ENCODINGS = ("utf-8", "utf-16", "utf-32", "latin-1", "cp037", "utf-7", "shift_jis", "nonsense")


class HostileBlock:
    """Builds one block from `random`."""

    def __init__(self, random: Random) -> None:
        self._random = random
        self._names = [f"n{number}" for number in range(random.choice((1, 2, 5, 30, 260)))]

    def data(self) -> bytes:
        """The block's bytes."""
        random = self._random
        odd = random.random() < 0.2
        head = random.choice(HEADS).format(random.choice(ENCODINGS)) if odd else ""
        name = random.choice(("bml", "BML", "x:bml")) if odd else "bml"
        attributes = {
            "xmlns": random.choice((NAMESPACE, "", "other")) if odd else NAMESPACE,
            "id": random.choice(("", *WORDS)) if odd else "b1",
            "composition": random.choice(COMPOSITIONS[: None if odd else 4]),
        }
        inner = "".join(self._element() for _ in range(random.choice((0, 1, 3, 5, 10, 60))))
        if random.random() < 0.02:
            inner += "".join(self._element() for _ in range(400))
        text = f"{head}<{name}{_written(attributes)}>{inner}</{name}>"
        if random.random() < 0.03:
            text = self._deep(text)
        data = text.encode("utf-16" if odd and random.random() < 0.2 else "utf-8", "replace")
        return self._damaged(data) if random.random() < 0.1 else data

    def _deep(self, text: str) -> str:
        depth = self._random.choice((50, 2000, 30_000))
        opening, closing = "<required>" * depth, "</required>" * depth
        return text.replace("><", f">{opening}{closing}<", 1)

    def _damaged(self, data: bytes) -> bytes:
        random, bent = self._random, bytearray(data)
        for _ in range(random.randint(1, 20)):
            at = random.randrange(len(bent) + 1)
            match random.randrange(4):
                case 0:
                    bent[at : at + 1] = random.randbytes(1)
                case 1:
                    del bent[at : at + random.randint(1, 200)]
                case 2:
                    bent[at:at] = bent[at : at + random.randint(1, 200)]
                case _:
                    bent[at:at] = random.choice((b"\0", b"&#0;", b"]]>", b"<!--", b"\xff\xfe"))
        return bytes(bent)

    def _element(self) -> str:
        random = self._random
        inner = self._constraint() if random.random() < 0.3 else self._behaviour()
        return f"<required>{inner}</required>" if random.random() < 0.1 else inner

    def _behaviour(self) -> str:
        random = self._random
        kind = random.choice((*SYNC_POINTS, "dance", "speech", "bml"))
        attributes = {"id": random.choice((*self._names, *self._names, "", *WORDS))}
        for name in REQUIRED_ATTRIBUTES.get(kind, ()):
            if random.random() < 0.9:
                attributes[name] = random.choice(WORDS)
        for point in SYNC_POINTS.get(kind, ()):
            if random.random() < 0.3:
                attributes[point] = self._time()
        for name in ("repetition", "amount", "offsetAngle", "mode"):
            if random.random() < 0.1:
                attributes[name] = random.choice(NUMBERS)
        if random.random() < 0.02:
            attributes |= {f"a{number}": "x" for number in range(1000)}
        inner = ""
        if kind == "speech":
            marks = "".join(
                f"word <sync id={quoteattr(random.choice((f'm{number}', *WORDS)))}/>"
                for number in range(random.choice((0, 1, 5, 5, 5, 700)))
            )
            inner = f"<text>{marks}word <b>word</b></text>" * random.choice((0, 1, 1, 1, 2))
        elif random.random() < 0.1:
            inner = f"<stance type={quoteattr(random.choice(WORDS))}/>" * random.randint(1, 50)
        return f"<{kind}{_written(attributes)}>{inner}</{kind}>"

    def _constraint(self) -> str:
        random = self._random
        kind = random.choice(("synchronize", "before", "after", "during"))
        syncs = "".join(
            f"<sync ref={quoteattr(self._time())}/>"
            for _ in range(random.choice((0, 1, 1, 2, 2, 2, 2, 60)))
        )
        ref = _written({"ref": self._time()}) if random.random() < 0.8 else ""
        return f"<constraint id='c'><{kind}{ref}>{syncs}</{kind}></constraint>"

    def _time(self) -> str:
        random = self._random
        if random.random() < 0.05:
            return random.choice((*NUMBERS, *WORDS))
        if random.random() < 0.3:
            return random.choice(("0", "1", "0.5", "2", "3", "9", "100"))
        point = random.choice(("start", "end", "stroke", "ready", "m1", "relax", "stroke:2", "x"))
        block = random.choice(("", "", "", "", "", "", "b0:", "b1:"))
        offset = random.choice(("", "", "", "+1", " - 0.5"))
        if random.random() < 0.02:
            offset = f"+{random.choice(NUMBERS)}"
        return f"{block}{random.choice(self._names)}:{point}{offset}"


def _written(attributes: dict[str, str]) -> str:
    return "".join(f" {name}={quoteattr(value)}" for name, value in attributes.items())


def hostile_frames(random: Random) -> bytes:
    """What a broker might send: frames of STOMP, from right to nonsense."""
    data = b""
    for _ in range(random.randint(1, 5)):
        command = random.choice(("MESSAGE", "CONNECTED", "ERROR", "RECEIPT", "", "\r", "x" * 3000))
        headers = "".join(
            random.choice(("a:b", "content-length:", "destination:/x", "\\q:\\", ":", "no colon"))
            + random.choice(("", *NUMBERS, *WORDS))
            + random.choice(("\n", "\n", "\r\n", "\0"))
            for _ in range(random.choice((0, 1, 4, 150)))
        )
        body = HostileBlock(random).data() if random.random() < 0.3 else random.randbytes(30)
        end = random.choice((b"\0", b"\0\n\n", b"", b"\n"))
        data += (command + "\n" + headers + "\n").encode("utf-8", "replace") + body + end
    return data
