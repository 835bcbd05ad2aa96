"""The bytes of a regular file, with a bound: no device, no pipe, nothing endless."""

import os
import stat
from pathlib import Path
from typing import BinaryIO

from kinetix.errors import KinetixError
from kinetix.files.limits import LIMITS, MIB, Kind

_OPEN = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0)
_OPEN |= getattr(os, "O_BINARY", 0)


class FileError(KinetixError):
    """A file cannot be read, or is not what it should be.

    Attributes:
        file: Its name.
        reason: The rest of the sentence.
    """

    def __init__(self, file: str | Path, reason: str) -> None:
        super().__init__(f"{file}: {reason}")
        self.file = str(file)
        self.reason = reason


def open_regular(path: Path, kind: Kind) -> BinaryIO:
    """Open a regular file of bounded size; opening never waits for a writer.

    Raises:
        FileError: The file is missing, not a regular file, or too large.
    """
    try:
        descriptor = os.open(path, _OPEN)
    except OSError as error:
        raise FileError(path, f"cannot be read: {error.strerror or error}") from error
    except ValueError as error:  # a name with a null character in it
        raise FileError(path, f"cannot be read: {error}") from error
    try:
        status = os.fstat(descriptor)
        if stat.S_ISDIR(status.st_mode):
            raise FileError(path, "expected a file, got a folder")
        if not stat.S_ISREG(status.st_mode):
            raise FileError(path, "expected a regular file, got a device, pipe or socket")
        largest = LIMITS[kind].largest
        if status.st_size > largest:
            raise FileError(path, f"expected a file of at most {largest // MIB} MiB")
        return open(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def read_bytes(path: Path, kind: Kind) -> bytes:
    """Return the content of a file.

    Raises:
        FileError: As for `open_regular`.
    """
    largest = LIMITS[kind].largest
    with open_regular(path, kind) as file:
        try:
            data = file.read(largest + 1)
        except OSError as error:
            raise FileError(path, f"cannot be read: {error.strerror or error}") from error
    if len(data) > largest:  # it has grown meanwhile
        raise FileError(path, f"expected a file of at most {largest // MIB} MiB")
    return data


def decode_text(data: bytes, file: str | Path) -> str:
    """Decode bytes as UTF-8 text.

    Raises:
        FileError: The bytes are not UTF-8.
    """
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        byte = data[error.start]
        raise FileError(
            file, f"expected UTF-8 text, got byte {error.start} as 0x{byte:02x}"
        ) from None


def read_text(path: Path, kind: Kind) -> str:
    """Return the text of a file.

    Raises:
        FileError: As for `open_regular`, or it is not UTF-8.
    """
    return decode_text(read_bytes(path, kind), path)
