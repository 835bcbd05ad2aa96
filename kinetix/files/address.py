"""Files from an address: bounded in size and time, only from the web, nothing runs."""

import http.client
import os
import re
import threading
import time
import urllib.error
import urllib.parse
import urllib.request
from concurrent.futures import Future
from pathlib import PurePosixPath
from typing import Any, Final

from kinetix.files.limits import LIMITS, MIB, Kind
from kinetix.files.regular import FileError

SCHEMES: Final = ("https", "http")
SECONDS: Final = 20.0
"""Longest silence of a server."""
LONGEST_SECONDS: Final = 300.0
"""Longest time that a file takes to come."""
_PIECE: Final = 2**16
_NOT_IN_NAMES: Final = re.compile(r'[\x00-\x1f\x7f/\\:*?"<>|]')
"""Characters that some system allows in no file's name."""
_KEPT: Final = "%/:@!$&'()*+,;=~?"
"""Characters of a path and a query that mean themselves, besides letters and digits."""
_LONGEST_STEM: Final = 40
_LONGEST_SUFFIX: Final = 10
"""Characters of a name, which are up to four bytes each; disks take 255 bytes."""


class _Redirects(urllib.request.HTTPRedirectHandler):
    """Follows a server elsewhere on the web, and nowhere else."""

    def redirect_request(
        self, req: Any, fp: Any, code: int, msg: str, headers: Any, newurl: str
    ) -> Any:
        if not is_address(newurl):
            raise FileError(req.full_url, f"leads to {newurl}, which is no address on the web")
        return super().redirect_request(req, fp, code, msg, headers, newurl)


def is_address(words: str | os.PathLike[str]) -> bool:
    """Return whether words are an address on the web, such as `https://example.org/level.json`."""
    try:
        parts = urllib.parse.urlsplit(os.fspath(words))
    except ValueError:  # such as a bracket that is never closed
        return False
    return parts.scheme.lower() in SCHEMES and bool(parts.netloc)


def name_of(address: str) -> str:
    """Return the file's name at the end of an address, shortened to one that every disk takes.

    Where the address has none, or nothing of it can be part of a file's name, it is `file`.
    """
    path = urllib.parse.unquote(urllib.parse.urlsplit(address).path)
    name = PurePosixPath(_NOT_IN_NAMES.sub("", PurePosixPath(path).name).strip(". "))
    return f"{name.stem[:_LONGEST_STEM]}{name.suffix[:_LONGEST_SUFFIX]}" or "file"


def fetch(address: str, kind: Kind) -> bytes:
    """Return the content of an address.

    Args:
        address: Begins with `https://` or `http://`.
        kind: Whose limit of size holds.

    Raises:
        FileError: The address is not valid, cannot be reached, is too large or too slow, or breaks
            off; one sentence.
    """
    if not is_address(address):
        raise FileError(address, "expected an address that begins with https:// or http://")
    answered: Future[bytes] = Future()
    # In a thread, which is left to itself when it is late: a server that sends its headers byte by
    # byte is never silent.
    threading.Thread(target=_answer, args=(answered, address, kind), daemon=True).start()
    try:
        return answered.result(LONGEST_SECONDS)
    except TimeoutError:
        raise _too_slow(address) from None


def _answer(answered: Future[bytes], address: str, kind: Kind) -> None:
    try:
        answered.set_result(_fetched(address, kind))
    except BaseException as error:
        answered.set_exception(error)


def _too_slow(address: str) -> FileError:
    return FileError(address, f"expected to come in {LONGEST_SECONDS:.0f} s, was too slow")


def _fetched(address: str, kind: Kind) -> bytes:
    opener = urllib.request.build_opener(_Redirects)
    try:
        with opener.open(_in_ascii(address), timeout=SECONDS) as answer:
            return _content(answer, address, LIMITS[kind].largest)
    except urllib.error.HTTPError as error:
        error.close()
        raise FileError(address, f"the server says {error.code} {error.reason}") from None
    except http.client.IncompleteRead:
        raise FileError(address, "broke off; try again") from None
    except (urllib.error.URLError, http.client.HTTPException, OSError, ValueError) as error:
        reason = getattr(error, "reason", None) or error
        raise FileError(address, f"cannot be reached: {reason}") from None


def _content(answer: Any, address: str, largest: int) -> bytes:
    """Read an answer piece by piece, as a server that never ends is not silent."""
    until, promised = time.monotonic() + LONGEST_SECONDS, answer.length
    data = bytearray()
    while piece := answer.read1(_PIECE):
        data += piece
        if len(data) > largest:
            raise FileError(address, f"expected at most {largest // MIB} MiB")
        if time.monotonic() > until:
            raise _too_slow(address)
    if promised and len(data) < promised:
        raise FileError(address, f"broke off after {len(data)} of {promised} bytes; try again")
    return bytes(data)


def _in_ascii(address: str) -> str:
    """The address with spaces and letters of other alphabets in the form that servers take."""
    parts = urllib.parse.urlsplit(address)
    path, query = (urllib.parse.quote(part, safe=_KEPT) for part in (parts.path, parts.query))
    return parts._replace(path=path, query=query).geturl()
