"""What programs share that try something with real sessions again and again."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from tests.e2e.lab import Lab


@dataclass
class Found:
    """What the rounds showed."""

    #: What was not as it should be.
    complaints: list[str] = field(default_factory=list)

    def sentence(self) -> str:
        """All of it."""
        raise NotImplementedError


def main(
    run: Callable[..., Found],
    doc: str | None,
    rounds: int,
    switches: Mapping[str, str] | None = None,
) -> int:
    """Run as a program: `rounds` of them unless it is told otherwise. `switches` are options that
    `run` takes beside the lab, the rounds and a seed, with what they mean.
    """
    parser = argparse.ArgumentParser(description=doc)
    parser.add_argument("--rounds", type=int, default=rounds)
    parser.add_argument("--seed", type=int, default=7)
    for name, meaning in (switches or {}).items():
        parser.add_argument(f"--{name}", action="store_true", help=meaning)
    options = vars(parser.parse_args())
    with Lab() as lab:
        found = run(lab, options.pop("rounds"), options.pop("seed"), **options)
    sys.stdout.write(f"{found.sentence()}, {len(found.complaints)} complaints\n")
    sys.stdout.writelines(f"{complaint}\n" for complaint in found.complaints)
    return 1 if found.complaints else 0
