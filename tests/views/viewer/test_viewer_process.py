"""The viewer as a process of its own: ports, closed tabs and Ctrl-C."""

from __future__ import annotations

import signal
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlsplit
from urllib.request import urlopen

import pytest

from cagepose.views.viewer.server import open_server
from driving import HOST, free_port, wait_until

RAIL = Path(__file__).resolve().parents[3] / "scenes" / "rail-pitch.yaml"
ENDED = (0, "\nended\n", "")
"""Exit code, and what a viewer says after its address until Ctrl-C has ended it."""


class Viewer(NamedTuple):
    process: subprocess.Popen[str]
    address: str
    said: list[str]

    def end(self) -> tuple[int, str, str]:
        """Press Ctrl-C."""
        self.process.send_signal(signal.SIGINT)
        out, err = self.process.communicate(timeout=20)
        return self.process.returncode, out, err


@contextmanager
def viewer(*options: str) -> Iterator[Viewer]:
    command = [sys.executable, "-m", "cagepose", "view", str(RAIL), *options]
    # Where the tests run in the background, a shell makes them ignore Ctrl-C, and their children too.
    heeding = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **heeding)
    try:
        said = [process.stdout.readline()]
        if ": open " not in said[-1]:
            said.append(process.stdout.readline())
        yield Viewer(process, said[-1].split(": open ")[1].split()[0], said)
    finally:
        process.kill()
        process.communicate()


def post_and_hang_up(address: str) -> None:
    """Ask for a run and reset the connection at once, as a tab does that is closed while its slider moves."""
    port, path = urlsplit(address).port, urlsplit(address).path
    with socket.create_connection((HOST, port)) as caller:
        caller.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        caller.sendall(
            f"POST {path}run HTTP/1.1\r\nHost: {HOST}:{port}\r\nContent-Type: application/json\r\n"
            "Content-Length: 2\r\n\r\n{}".encode()
        )


def test_a_taken_port_gives_the_next_free_one_and_says_so():
    with socket.create_server((HOST, free_port())) as taken:
        port = taken.getsockname()[1]
        with viewer("--port", str(port)) as shown:
            assert shown.said[0] == f"port {port} is in use; using {urlsplit(shown.address).port}\n"
            with urlopen(shown.address, timeout=10) as answer:
                assert b'id="scene"' in answer.read()
            assert shown.end() == ENDED


def test_a_closed_tab_leaves_the_viewer_running_and_ctrl_c_ends_it_cleanly(watched):
    port = free_port()
    began = time.perf_counter()
    with viewer("--port", str(port)) as shown:
        assert len(shown.said) == 1
        watched.page.goto(shown.address)
        wait_until(watched.page, "cagepose.state().drawn > 0")
        print(f"from command to visible scene: {time.perf_counter() - began:.1f} s")
        watched.page.close()
        for _ in range(5):
            post_and_hang_up(shown.address)
        time.sleep(0.5)
        again = watched.page.context.browser.new_page()
        again.goto(shown.address)
        wait_until(again, "cagepose.state().drawn > 0")
        assert shown.end() == ENDED  # while a tab is open
        again.close()


def test_where_no_port_is_free_the_ports_tried_are_named(monkeypatch):
    monkeypatch.setattr("cagepose.views.viewer.server.PORTS_TRIED", 1)
    with socket.create_server((HOST, free_port())) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(OSError, match=f"no port from {port} to {port} is free; name another"):
            open_server("", None, HOST, port)
