"""The live viewer: the page, and a server on this machine that runs the scene when its text is edited, a slider moves
or a hand pulls.

The server keeps nothing between two questions, so that windows cannot disturb each other: each sends its text and
values. It answers only who names it by its own name, and takes values only as JSON, which a page from elsewhere cannot
send: no other page that is open in the same browser can use it. What it serves lies below a folder with a random name,
which stands in the address: nobody else who is logged in on the same machine can use it either.
"""

from __future__ import annotations

import errno
import json
import os
import secrets
import sys
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from cagepose.errors import CageposeError
from cagepose.files.read import MAX_FILE_BYTES
from cagepose.views.viewer.editing import Desk

PORTS_TRIED = 50
"""From the first one up."""
KEY_BYTES = 12
MAX_BODY_BYTES = 2 * MAX_FILE_BYTES
"""A text has escapes for its line ends and quotes on its way."""
LOOPBACK = ("127.0.0.1", "localhost")


class ViewServer(ThreadingHTTPServer):
    """Serves one page, and answers what its controls ask if there is a scene file beside it."""

    daemon_threads = True
    # Else the port of a viewer that has just ended is taken for a minute, and a page that is still open asks in vain.
    # On Windows, a port that somebody else listens on would then seem free.
    allow_reuse_address = os.name != "nt"

    def __init__(self, page: str, desk: Desk | None, host: str, port: int) -> None:
        self.page = page.encode()
        self.desk = desk
        super().__init__((host, port), _Answers)
        self.root = f"/{secrets.token_urlsafe(KEY_BYTES)}"
        self.names = {f"{name}:{self.server_port}" for name in LOOPBACK} if host in LOOPBACK else None

    @property
    def address(self) -> str:
        """Where a browser finds it."""
        return f"http://{self.server_address[0]!s}:{self.server_port}{self.root}/"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Tell of what went wrong, but not of a tab that was closed while its answer was on the way."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)


def open_server(page: str, desk: Desk | None, host: str, port: int) -> ViewServer:
    """Return a server that listens on ``port``, or on the next free one; it answers once `serve_forever` is called.

    Raises
    ------
    OSError
        No such host, or no port is free.
    """
    for candidate in range(port, min(port + PORTS_TRIED, 2**16)):
        try:
            return ViewServer(page, desk, host, candidate)
        except OSError as error:
            if error.errno not in (errno.EADDRINUSE, errno.EACCES):
                raise
    raise OSError(f"no port from {port} to {min(port + PORTS_TRIED, 2**16) - 1} is free; name another")


class _Answers(BaseHTTPRequestHandler):
    server: ViewServer
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True  # else head and body are sent 40 ms apart
    timeout = 60.0

    def do_GET(self) -> None:
        if not self._is_meant():
            return
        if self.path != f"{self.server.root}/":
            self._send(HTTPStatus.NOT_FOUND, "text/plain", b"open the address that cagepose view printed\n")
            return
        self._send(HTTPStatus.OK, "text/html", self.server.page)

    def do_POST(self) -> None:
        if not self._is_meant():
            return
        desk = self.server.desk
        name = self.path.removeprefix(self.server.root)
        answer = None if desk is None or name == self.path else desk.answers.get(name)
        if desk is None or answer is None:
            self.close_connection = True  # what was sent is left unread, and must not be taken for the next request
            self._send(HTTPStatus.NOT_FOUND, "text/plain", b"nothing can be changed here\n")
            return
        try:
            found = answer(self._question())
        except (CageposeError, ValueError, TimeoutError, OSError) as error:
            self._send_json(HTTPStatus.UNPROCESSABLE_ENTITY, desk.refusal(error))
        else:
            self._send_json(HTTPStatus.OK, found)

    def _is_meant(self) -> bool:
        names = self.server.names
        if names is None or self.headers.get("Host") in names:
            return True
        self.close_connection = True
        self._send(HTTPStatus.FORBIDDEN, "text/plain", b"this server answers only under its own name\n")
        return False

    def _question(self) -> dict[str, Any]:
        length = self.headers.get("Content-Length") or ""
        if not (length.isascii() and length.isdigit() and int(length) <= MAX_BODY_BYTES):
            self.close_connection = True
            raise ValueError("too much was sent" if length.isdigit() else "the length of what was sent is missing")
        body = self.rfile.read(int(length))
        if self.headers.get_content_type() != "application/json":
            raise ValueError("values must be sent as JSON")
        try:
            question = json.loads(body)
        except RecursionError:
            raise ValueError("values are nested too deep") from None
        if not isinstance(question, dict):
            raise ValueError("what is asked is no mapping")
        return question

    def _send_json(self, status: HTTPStatus, content: dict[str, Any]) -> None:
        self._send(status, "application/json", json.dumps(content, allow_nan=False, separators=(",", ":")).encode())

    def _send(self, status: HTTPStatus, kind: str, content: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", f"{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *arguments: object) -> None:
        """Print nothing: every slider asks many times."""
