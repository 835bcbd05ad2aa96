"""The page's server: one page, one stream of pictures, one place that takes input, one user."""

import hmac
import json
import secrets
import select
import socket
import sys
import threading
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, Final
from urllib.parse import parse_qs, urlsplit

from editor.hosts.web.messages import GONE, LONGEST, Message, read
from editor.hosts.web.outlet import Outlet
from kinetix.errors import KinetixError

PORT: Final = 8570
"""The port that is tried first where none is asked for."""
_PAGE: Final = Path(__file__).with_name("page.html")
_LARGEST: Final = 6 * LONGEST + 2**16
"""Most bytes of input in one request: a text fits whose characters take six bytes each in JSON."""
_DIGITS: Final = 10
"""Most digits of the length of a request."""
_SILENT_FOR: Final = 15_000
"""A page that does not answer the network for this time is gone [ms]."""
TAKEN: Final = "Kinetix is open in another page: close that page, then try again here."
_NO_MORE: Final[Mapping[str, str]] = {}
_ASTRAY: Final = "Nothing is here: open the whole address that kinetix-editor has printed."
_POLICY: Final = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; connect-src 'self'; frame-ancestors 'self'; "
    "base-uri 'none'; form-action 'none'"
)


class Seat:
    """The one place of a user; it is free again as soon as the page's connection is closed."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._viewer = ""
        self._connection: socket.socket | None = None

    def take(self, viewer: str, connection: socket.socket) -> bool:
        """Sit down unless somebody else sits there; returns whether that worked.

        Args:
            viewer: The page's own name.
            connection: What its pictures go through.
        """
        with self._lock:
            free = self._connection is None or _closed(self._connection)
            if not (free or viewer == self._viewer):
                return False
            self._viewer, self._connection = viewer, connection
            return True

    def leave(self, connection: socket.socket) -> None:
        """Stand up; nothing happens if another connection sits there by now."""
        with self._lock:
            if self._connection is connection:
                self._connection = None

    def holds(self, viewer: str) -> bool:
        """Return whether a page has the seat."""
        with self._lock:
            return self._connection is not None and viewer == self._viewer


def _closed(connection: socket.socket) -> bool:
    """Return whether the other end has closed a connection."""
    try:
        readable, _, _ = select.select([connection], [], [], 0)
        return bool(readable) and connection.recv(1, socket.MSG_PEEK) == b""
    except (OSError, ValueError):
        return True


class PageServer:
    """Serves the app's page on a port, in threads of its own."""

    def __init__(
        self,
        outlet: Outlet,
        take: Callable[[list[Message]], None],
        *,
        address: str = "127.0.0.1",
        port: int | None = None,
    ) -> None:
        """Bind the port; nothing is answered before `start`.

        Args:
            outlet: Where pictures come from.
            take: Takes the page's messages, in any thread.
            address: What to listen on.
            port: The port; None: 8570, or a free one where that is taken.

        Raises:
            KinetixError: The address or the port cannot be had.
        """
        self.outlet = outlet
        self.take = take
        self.secret = secrets.token_urlsafe(16)
        self.seat = Seat()
        self._server = _bound(address, port)
        self._server.page_server = self
        self._address = address
        self._thread: threading.Thread | None = None

    @property
    def url(self) -> str:
        """The address to open, with its secret."""
        host = socket.gethostname() if self._address in ("0.0.0.0", "::", "") else self._address
        host = f"[{host}]" if ":" in host else host
        return f"http://{host}:{self.port}/{self.secret}/"

    @property
    def port(self) -> int:
        """The port that is listened on."""
        return self._server.server_address[1]

    def start(self) -> None:
        """Answer from now on."""
        self._thread = threading.Thread(target=self._server.serve_forever, name="page", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop answering."""
        if self._thread is not None:
            self._server.shutdown()
        self._server.server_close()


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    # A port that another program listens on must not be shared with it.
    allow_reuse_port = False
    page_server: PageServer

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore pages that went away; report anything else as usual."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


class _ServerV6(_Server):
    address_family = socket.AF_INET6


def _bound(address: str, port: int | None) -> _Server:
    kind = _ServerV6 if ":" in address else _Server
    tried = [PORT, 0] if port is None else [port]
    for k, number in enumerate(tried):
        try:
            return kind((address, number), _Handler)
        except (OSError, OverflowError) as error:
            if k == len(tried) - 1:
                reason = getattr(error, "strerror", None) or error
                raise KinetixError(
                    f"--serve: cannot listen on {address}:{number}: {reason}; "
                    "choose another with --port or --address"
                ) from error
    raise AssertionError


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server_version = "Kinetix"
    sys_version = ""
    disable_nagle_algorithm = True
    timeout = 3600.0
    server: _Server  # pyright: ignore[reportIncompatibleVariableOverride]

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing: the terminal belongs to the app."""

    def do_GET(self) -> None:
        """Answer with the page, or with its stream."""
        place, viewer = self._place()
        if place == "":
            # Terminals and chats leave the last slash out of a link.
            secret = self.server.page_server.secret
            self._say(HTTPStatus.PERMANENT_REDIRECT, b"", "text/plain", {"Location": f"{secret}/"})
        elif place == "/":
            self._say(HTTPStatus.OK, _PAGE.read_bytes(), "text/html; charset=utf-8")
        elif place == "/stream" and viewer:
            self._stream(viewer)
        else:
            self._refuse(HTTPStatus.NOT_FOUND, _ASTRAY)

    def do_POST(self) -> None:
        """Take input from the page that has the seat."""
        place, viewer = self._place()
        page = self.server.page_server
        if place != "/input":
            self._refuse_unread(HTTPStatus.NOT_FOUND, _ASTRAY)
            return
        if not page.seat.holds(viewer):
            self._refuse_unread(HTTPStatus.CONFLICT, TAKEN)
            return
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or len(length) > _DIGITS or int(length) > _LARGEST:
            status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE
            self._refuse_unread(status, "That is too much input at once.")
            return
        body = self.rfile.read(int(length))
        try:
            messages, faults = read(json.loads(body))
        except (ValueError, RecursionError, KinetixError) as error:
            self._refuse(HTTPStatus.BAD_REQUEST, str(error))
            return
        # One message that is refused does not take the others with it: keys would stay down.
        page.take(messages)
        if faults:
            self._refuse(HTTPStatus.BAD_REQUEST, str(faults[0]))
        else:
            self._say(HTTPStatus.NO_CONTENT, b"", "text/plain")

    def _place(self) -> tuple[str | None, str]:
        """Return what stands behind the secret, and the page's name; None: no right secret."""
        try:
            parts = urlsplit(self.path)
        except ValueError:
            return None, ""
        _, _, rest = parts.path.partition("/")
        secret, slash, place = rest.partition("/")
        right = hmac.compare_digest(secret.encode(), self.server.page_server.secret.encode())
        viewer = parse_qs(parts.query).get("viewer", [""])[0]
        return (slash + place if right else None), viewer

    def _say(
        self, status: HTTPStatus, body: bytes, kind: str, more: Mapping[str, str] = _NO_MORE
    ) -> None:
        self.send_response(status)
        headers = {
            "Content-Type": kind,
            "Cache-Control": "no-store",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
            "Content-Security-Policy": _POLICY,
        }
        for name, value in {**headers, **more}.items():
            self.send_header(name, value)
        if status is not HTTPStatus.NO_CONTENT:
            self.send_header("Content-Length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def _refuse(self, status: HTTPStatus, sentence: str) -> None:
        self._say(status, f"{sentence}\n".encode(), "text/plain; charset=utf-8")

    def _refuse_unread(self, status: HTTPStatus, sentence: str) -> None:
        """Refuse without reading the input, which ends the connection."""
        self.close_connection = True
        self._refuse(status, sentence)

    def _stream(self, viewer: str) -> None:
        """Send pictures until the page goes."""
        page = self.server.page_server
        if not page.seat.take(viewer, self.connection):
            self._refuse(HTTPStatus.CONFLICT, TAKEN)
            return
        self.close_connection = True
        if hasattr(socket, "TCP_USER_TIMEOUT"):
            level, option = socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT
            self.connection.setsockopt(level, option, _SILENT_FOR)
        connection = page.outlet.attach()
        # The same page may be back before its last line's end was noticed: what was held there is
        # let go of here.
        page.take(list(GONE))
        try:
            self.send_response(HTTPStatus.OK)
            for name, value in (
                ("Content-Type", "application/octet-stream"),
                ("Cache-Control", "no-store"),
                # Proxies must not collect pictures before they pass them on.
                ("X-Accel-Buffering", "no"),
                ("Connection", "close"),
            ):
                self.send_header(name, value)
            self.end_headers()
            for packet in page.outlet.packets(connection):
                self.wfile.write(packet)
        except OSError:
            pass
        finally:
            page.seat.leave(self.connection)
            if page.outlet.detach(connection):
                page.take(list(GONE))
