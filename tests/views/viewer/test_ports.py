"""Which port the viewer's server takes."""

from __future__ import annotations

import http.client
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from cagepose.views.viewer.server import ViewServer, open_server
from driving import HOST, free_port


@contextmanager
def serving(port: int) -> Iterator[ViewServer]:
    with open_server("page", None, HOST, port) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.02})
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


def test_a_viewer_that_ended_leaves_its_port_to_the_next_one_while_a_page_is_still_open():
    port = free_port()
    with serving(port) as server:
        page = http.client.HTTPConnection(HOST, server.server_port, timeout=10)
        page.request("GET", f"{server.root}/")
        assert page.getresponse().read() == b"page"
    with serving(port) as server:
        assert server.server_port == port
        again = http.client.HTTPConnection(HOST, port, timeout=10)
        again.request("GET", f"{server.root}/")
        assert again.getresponse().read() == b"page"
        again.close()
    page.close()


def test_a_port_on_which_somebody_listens_is_left_alone():
    with serving(free_port()) as one, serving(one.server_port) as other:
        assert one.server_port < other.server_port


def test_only_who_knows_the_address_gets_the_page():
    with serving(free_port()) as one, serving(free_port()) as other:
        assert one.root != other.root
        assert len(one.root) > 16
        for path in ("/", other.root + "/", one.root):
            asked = http.client.HTTPConnection(HOST, one.server_port, timeout=10)
            asked.request("GET", path)
            assert asked.getresponse().status == 404
            asked.close()
