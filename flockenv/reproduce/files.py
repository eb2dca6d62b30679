"""The files of a reproduction: pictures, tables, claims; each written whole or not at all."""

import io
import re
from collections.abc import Iterable
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from flockenv._io.atomic_write import atomic_write
from flockenv.reproduce.claim import CheckedClaim
from flockenv.reproduce.reproduction import Outcome
from flockenv.reproduce.style import paper_style
from flockenv.runs.store import StorageError

__all__ = [
    "PNG_DPI",
    "claims_table",
    "csv_bytes",
    "picture_bytes",
    "write_file",
    "write_outcome",
    "write_table",
]

PNG_DPI = 300


def write_file(path: Path, content: bytes) -> None:
    """Write a file and the folders above it.

    Raises
    ------
    StorageError
        If it cannot be written; what was there before is still there.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_write(path) as file:
            file.write(content)
    except OSError as error:
        raise StorageError(f"{path} cannot be written: {error.strerror or error}") from error


def picture_bytes(figure: Figure, form: str) -> bytes:
    """Return a figure as "png" or "svg", without a date: the same figure, the same bytes."""
    buffer = io.BytesIO()
    metadata = {"Date": None} if form == "svg" else {"Software": None}
    with paper_style():
        figure.savefig(buffer, format=form, dpi=PNG_DPI, metadata=metadata)
    return _with_numbered_clips(buffer.getvalue()) if form == "svg" else buffer.getvalue()


def _with_numbered_clips(svg: bytes) -> bytes:
    """Rename clips by number: matplotlib's names depend on the last bits of coordinates."""
    numbers: dict[bytes, int] = {}
    return re.sub(
        rb"(?<=[\"#])p[0-9a-f]{10}(?=[\")])",
        lambda name: b"clip%d" % numbers.setdefault(name[0], len(numbers)),
        svg,
    )


def csv_bytes(table: pd.DataFrame) -> bytes:
    """Return a table as CSV, six significant digits."""
    return table.to_csv(index=False, float_format="%.6g", lineterminator="\n").encode()


def write_table(table: pd.DataFrame, stem: Path) -> None:
    """Write a table as CSV (6 significant digits) and Parquet (all of them)."""
    write_file(stem.with_suffix(".csv"), csv_bytes(table))
    buffer = io.BytesIO()
    table.to_parquet(buffer, index=False)
    write_file(stem.with_suffix(".parquet"), buffer.getvalue())


def claims_table(claims: Iterable[CheckedClaim]) -> pd.DataFrame:
    """Return a row for each claim."""
    return pd.DataFrame([claim.row() for claim in claims])


def write_outcome(outcome: Outcome, folder: Path) -> None:
    """Write all pictures and tables of an outcome, its claims as ``claims.csv``, into a folder."""
    for name, table in outcome.tables.items():
        write_table(table, folder / name)
    for name, figure in outcome.pictures.items():
        for form in ("png", "svg"):
            write_file(folder / f"{name}.{form}", picture_bytes(figure, form))
    if outcome.claims:
        write_table(claims_table(outcome.claims), folder / "claims")
