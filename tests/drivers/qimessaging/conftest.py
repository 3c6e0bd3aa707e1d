"""The other ends against which our own are tested: processes with the qi package, and scripts."""

from __future__ import annotations

import os
import ssl
import subprocess
import sys
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest
from qimessaging import NaoqiClient

from tests.drivers.qimessaging.messaging_rig import QiCaller
from tests.fakes import libqi

HERE = Path(__file__).parent
QUIET = {**os.environ, "QI_LOG_LEVEL": "0"}


def start_qi_service() -> tuple[subprocess.Popen[str], int]:
    process = subprocess.Popen(
        [sys.executable, str(HERE / "qi_service.py")],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=QUIET,
    )
    assert process.stdout is not None
    return process, int(process.stdout.readline())


def end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.communicate()


@pytest.fixture(scope="session")
def qi_port() -> Iterator[int]:
    """The port of a process with a listening `qi.Session`."""
    if not libqi.HERE:
        pytest.skip("the qi package has no wheels for this machine")
    process, port = start_qi_service()
    yield port
    end(process)


@pytest.fixture
def mortal_qi_service() -> Iterator[tuple[subprocess.Popen[str], int]]:
    """Such a process for one test alone, which may kill it."""
    if not libqi.HERE:
        pytest.skip("the qi package has no wheels for this machine")
    process, port = start_qi_service()
    yield process, port
    end(process)


@pytest.fixture
async def client(qi_port: int) -> AsyncIterator[NaoqiClient]:
    """Our client, connected to a `qi.Session`."""
    found = await NaoqiClient.open("127.0.0.1", qi_port)
    yield found
    await found.close()


@pytest.fixture
async def qi_caller() -> AsyncIterator[QiCaller]:
    """The qi package as a client, in a process of its own."""
    if not libqi.HERE:
        pytest.skip("the qi package has no wheels for this machine")
    caller = await QiCaller.start(HERE / "qi_caller.py", QUIET)
    yield caller
    await caller.end()


@pytest.fixture
def server_tls() -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(HERE / "certificate.pem", HERE / "key.pem")
    return context


@pytest.fixture
def client_tls() -> ssl.SSLContext:
    return ssl.create_default_context(cafile=HERE / "certificate.pem")
