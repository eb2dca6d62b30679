"""Files that are written whole or not at all."""

import atexit
import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

# A name is here before there is a file of that name, so that no moment is left out.
_temporary: set[Path] = set()


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a file for writing bytes: a temporary one beside it, renamed where all went well.

    It is removed on every way out but a kill, at the latest when Python ends. If the file cannot be
    written, which is an OSError, what was there before is still there.
    """
    target = Path(path)
    temporary = target.parent / f".{secrets.token_hex(8)}.tmp"
    _temporary.add(temporary)
    try:
        with temporary.open("xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)
        _temporary.discard(temporary)


@atexit.register
def remove_temporary_files() -> None:
    """Remove what unfinished writing left, before the process ends."""
    for path in tuple(_temporary):
        path.unlink(missing_ok=True)


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text to a file as UTF-8, as `atomic_write` does."""
    with atomic_write(path) as file:
        file.write(text.encode())


def write_csv(path: str | os.PathLike[str], table: "pd.DataFrame", **options: Any) -> None:
    """Write a table without its index to a CSV file, with the same bytes on every system.

    Options are those of ``to_csv``; the file is written as by `atomic_write`.
    """
    write_text(path, table.to_csv(index=False, lineterminator="\n", **options))
