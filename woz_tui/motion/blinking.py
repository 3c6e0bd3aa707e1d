"""Blinking: the eyes' height goes along a cosine from open to closed and back."""

from __future__ import annotations

import math
import random


class Blinks:
    """Decides when to blink, by chance that starts from `seed`, and how open the eyes are."""

    def __init__(self, seed: int) -> None:
        self._chance = random.Random(seed)
        self._waited = 0.0  # in mean pauses
        self._draw = self._chance.uniform(-0.5, 0.5)
        self._phase: float | None = None

    @property
    def blinking(self) -> bool:
        """Whether a blink is going on."""
        return self._phase is not None

    def begin(self) -> None:
        """Blink now; one that is going on is left alone."""
        if self._phase is None:
            self._phase = 0.0

    def open(self) -> None:
        """Have the eyes open at once."""
        self._phase = None

    def step(self, dt: float, rate: float, length: float, irregularity: float) -> float:
        """How open the eyes are, 0..1, `dt` seconds later.

        Args:
            dt: Seconds.
            rate: Blinks a minute; 0 for one who does not blink by itself.
            length: Seconds a blink takes.
            irregularity: 0..1; at 1 pauses lie between half and one and a half of the mean.
        """
        if self._phase is not None:
            self._phase += dt / length
            if self._phase >= 1.0:
                self._phase = None
        if rate > 0.0:
            self._waited += dt * rate / 60.0
            if self._waited >= 1.0 + irregularity * self._draw:
                self._waited = 0.0
                self._draw = self._chance.uniform(-0.5, 0.5)
                self.begin()
        if self._phase is None:
            return 1.0
        return 0.5 + 0.5 * math.cos(2.0 * math.pi * self._phase)
