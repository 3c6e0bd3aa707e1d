"""The simulated robot's microphones hear its own voice."""

from __future__ import annotations

import numpy as np
import pytest
from naoqi_simulator.audio import OWN_LATE_S, Echo, block
from naoqi_simulator.speech import SpeechManner, Words

from tests.fakes.naoqi import stand_in_here

RATE = 16_000


def loudness(echo: Echo, begin: float) -> float:
    """RMS of 85 ms, of full scale."""
    samples = block(None, begin, 1365, RATE, 1, echo=echo).astype(float)
    return float(np.sqrt((samples**2).mean())) / 32768


def test_it_is_heard_a_moment_after_it_spoke() -> None:
    echo = Echo(0.3, [(10.0, 12.0)])
    assert loudness(echo, 11.0) > 0.02 > loudness(echo, 9.9)
    assert loudness(echo, 12.0 + OWN_LATE_S - 0.1) > 0.02 > loudness(echo, 12.0 + OWN_LATE_S)
    assert loudness(Echo(0.3, [(10.0, None)]), 60.0) > 0.02, "it speaks still"


def test_how_loud_is_a_choice() -> None:
    spoke = [(10.0, 12.0)]
    assert loudness(Echo(0.0, spoke), 11.0) == loudness(Echo(), 11.0)
    ratio = loudness(Echo(0.8, spoke), 11.0) / loudness(Echo(0.4, spoke), 11.0)
    assert ratio == pytest.approx(2, rel=0.05)


async def test_the_voice_remembers_when_it_spoke() -> None:
    async with stand_in_here() as robot:
        world, voice = robot.pepper.world, robot.pepper.voice
        await voice.say([Words("hello", SpeechManner())], "hello", robot.pepper.animations)
        ((began, ended),) = world.spoke
        assert ended is not None
        assert ended - began > 0.2
        assert world.options.echo == 0.3
