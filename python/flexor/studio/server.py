"""The studio's server: one page and the requests that it makes, on the standard library."""

from __future__ import annotations

import errno
import hmac
import html
import ipaddress
import json
import secrets
import threading
import traceback
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

from flexor.errors import InputError
from flexor.model.toml import check_depth
from flexor.studio.search import methods, search
from flexor.studio.workbench import Workbench
from flexor.viewer.page import page

MAX_REQUEST = 1_000_000  # bytes
Answer = dict[str, Any] | str | bytes | Iterator[dict[str, Any]]


class Studio:
    """A running studio; made by `serve`.

    Attributes
    ----------
    url : str
        Where a browser finds it, with its token if there is one.
    """

    def __init__(self, bench: Workbench, host: str, port: int, token: str) -> None:
        self._server = _Server((host, port), bench, token)
        shown = f"[{host}]" if ":" in host else host
        self.url = f"http://{shown}:{self.port}/" + (f"?token={token}" if token else "")

    @property
    def port(self) -> int:
        """The port."""
        return int(self._server.server_address[1])

    def run(self) -> None:
        """Answer requests until interrupted."""
        try:
            self._server.serve_forever(poll_interval=0.2)
        finally:
            self._server.server_close()

    def start(self) -> Studio:
        """Answer requests in the background, as in a notebook."""
        threading.Thread(target=self.run, daemon=True).start()
        return self

    def stop(self) -> None:
        """End it."""
        self._server.shutdown()

    def _repr_html_(self) -> str:
        """Show it in a notebook on the same machine."""
        where = html.escape(self.url, quote=True)
        return f'<iframe src="{where}" width="100%" height="900" style="border:0"></iframe>'


def serve(bench: Workbench, host: str = "127.0.0.1", port: int = 0) -> Studio:
    """Open the studio of a model for browsers.

    Parameters
    ----------
    bench
        The model and what varies; see `workbench`.
    host
        Address to listen at. Whoever reaches one that is not a loopback address needs a token,
        which is part of `Studio.url`.
    port
        Port; any free one by default.

    Raises
    ------
    InputError
        If the port is in use, or the address is not one of this machine.
    """
    token = "" if _is_loopback(host) else secrets.token_urlsafe(24)
    try:
        return Studio(bench, host, port, token)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise InputError(
                f"port {port} of {host} is in use: give another with --port, or end what uses it."
            ) from None
        why = (error.strerror or str(error)).lower()
        raise InputError(f"cannot listen at {host}, port {port}: {why}.") from None
    except OverflowError:
        raise InputError(f"port is {port}: it must be from 0 to 65535.") from None


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    # On Linux a port in TIME_WAIT may be taken again; one in use may not.
    allow_reuse_address = True

    def __init__(self, address: tuple[str, int], bench: Workbench, token: str) -> None:
        import socket

        self.address_family = socket.AF_INET6 if ":" in address[0] else socket.AF_INET
        super().__init__(address, _Handler)
        self.bench, self.token = bench, token
        described = {**bench.describe(), "methods": methods()}
        self.page = page(described["title"], ["studio.js"], described, connects=True).encode()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of browsers that hang up."""


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server_version = "Flexor"
    server: _Server

    def do_GET(self) -> None:
        """Send the page."""
        if not self._is_allowed():
            return
        if urlsplit(self.path).path != "/":
            self._send(404, "text/plain; charset=utf-8", b"There is nothing here.")
            return
        self._send(200, "text/html; charset=utf-8", self.server.page)

    def do_POST(self) -> None:
        """Answer a request of the page."""
        if not self._is_allowed():
            return
        name = urlsplit(self.path).path.removeprefix("/api/")
        read = _ANSWERS.get(name)
        try:
            if read is None:
                raise InputError(f'there is no "{name}".')
            request = self._request()
            try:
                answer = read(request)
            except (KeyError, TypeError, ValueError, OverflowError) as error:
                raise InputError(f"the request is incomplete: {error!r}.") from None
            found = answer(self.server.bench)
        except InputError as error:
            self._send_json(400, {"error": str(error)})
            return
        except Exception as error:  # a defect, which is no fault of the request
            traceback.print_exc()
            self._send_json(500, {"error": f"a defect of Flexor: {error!r}."})
            return
        if isinstance(found, dict):
            self._send_json(200, found)
        elif isinstance(found, str):
            self._send(200, "text/plain; charset=utf-8", found.encode())
        elif isinstance(found, bytes):
            self._send(200, "application/octet-stream", found)
        else:
            self._stream(found)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing of each request."""

    def _request(self) -> dict[str, Any]:
        """Read the body; only what a page of another site cannot send unasked."""
        length = self.headers.get("Content-Length") or "0"
        if not length.isdecimal() or not 0 < int(length) <= MAX_REQUEST:
            self.close_connection = True  # with what has not been read
            raise InputError(f"a request has at least 1 byte and at most {MAX_REQUEST:,}.")
        body = self.rfile.read(int(length))
        if self.headers.get("Content-Type", "").split(";")[0] != "application/json":
            raise InputError("a request is JSON.")
        try:
            found = json.loads(body)
        except (ValueError, RecursionError):
            raise InputError("the request is not valid JSON, or nested too deeply.") from None
        if not isinstance(found, dict):
            raise InputError("a request is a JSON object.")
        check_depth(found, "the request")
        return found

    def _is_allowed(self) -> bool:
        """Check the token; without one, that the page was asked for by a loopback name.

        A site whose name has been pointed at this machine has another name.
        """
        token = self.server.token
        if token:
            query = parse_qs(urlsplit(self.path).query).get("token", [""])[0]
            given = self.headers.get("Authorization", "").removeprefix("Bearer ") or query
            if hmac.compare_digest(given.encode(), token.encode()):
                return True
            why = b"The token is missing or wrong: open the address that flexor studio printed."
            self._refuse(why)
            return False
        name = urlsplit(f"//{self.headers.get('Host', '')}").hostname or ""
        if _is_loopback(name):
            return True
        self._refuse(b"This studio is for its own machine: open it as localhost.")
        return False

    def _refuse(self, why: bytes) -> None:
        self.close_connection = True
        self._send(403, "text/plain; charset=utf-8", why)

    def _send_json(self, status: int, values: dict[str, Any]) -> None:
        text = json.dumps(values, allow_nan=False, separators=(",", ":"))
        self._send(status, "application/json", text.encode())

    def _send(self, status: int, kind: str, body: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Referrer-Policy", "no-referrer")
        self.end_headers()
        self.wfile.write(body)

    def _stream(self, rows: Iterator[dict[str, Any]]) -> None:
        """Send a line of JSON for each row, until the page stops listening."""
        self.send_response(200)
        self.send_header("Content-Type", "application/x-ndjson")
        self.send_header("Transfer-Encoding", "chunked")
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.close_connection = True
        try:
            for row in rows:
                self._chunk(row)
        except InputError as error:
            self._chunk({"error": str(error)})
        except OSError:
            return
        finally:
            close = getattr(rows, "close", None)
            if close is not None:
                close()
        self.wfile.write(b"0\r\n\r\n")

    def _chunk(self, row: dict[str, Any]) -> None:
        line = json.dumps(row, allow_nan=False, separators=(",", ":")).encode() + b"\n"
        self.wfile.write(f"{len(line):x}\r\n".encode() + line + b"\r\n")
        self.wfile.flush()


Request = dict[str, Any]


def _first(rows: Iterator[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Compute the first row now, so that a bad request is an error and no stream."""
    first = next(rows)

    def every() -> Iterator[dict[str, Any]]:
        try:
            yield first
            yield from rows
        finally:
            rows.close()  # type: ignore[attr-defined]

    return every()


def _asked(function: Callable[..., Answer], *arguments: Any) -> Callable[[Workbench], Answer]:
    return lambda bench: function(bench, *arguments)


def _landscape(bench: Workbench, *arguments: Any) -> Answer:
    return _first(bench.landscape(*arguments))


def _search(bench: Workbench, *arguments: Any) -> Answer:
    return _first(search(bench, *arguments))


# What a request asks of the workbench. Reading the request raises KeyError, TypeError, ValueError
# or OverflowError if it is incomplete.
_ANSWERS: dict[str, Callable[[Request], Callable[[Workbench], Answer]]] = {
    "solve": lambda r: _asked(
        Workbench.solve, r["values"], r["loads"], [str(each) for each in r.get("known", ())]
    ),
    "landscape": lambda r: _asked(
        _landscape, r["values"], r["loads"], [int(axis) for axis in r["axes"]], int(r["points"])
    ),
    "optimise": lambda r: _asked(
        _search, r["values"], r["loads"], str(r["method"]), int(r["budget"]), int(r["seed"])
    ),
    "model": lambda r: _asked(Workbench.model_file, r["values"]),
    "json": lambda r: _asked(Workbench.results, r["values"], r["loads"]),
    "stl": lambda r: _asked(Workbench.stl, r["values"], r["loads"], int(r["step"])),
    "share": lambda r: _asked(
        Workbench.share, [(str(d["title"]), d["values"], d["loads"]) for d in r["designs"]]
    ),
}
