"""Proof that a result file is what was written: a checksum of its bytes at its end, and one of its data inside.

The bytes are checked before any library reads them, so a damaged file neither changes a number nor upsets a reader. A
file that another program has copied into a new one has lost its last line; then the checksum of the data decides.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray

MARK = b"\npetalfoil sha256 "
"""Begins the last line of a file; NetCDF readers do not look beyond their own data."""
SEAL_LENGTH = len(MARK) + 64 + 1
BLOCK = 1 << 20


def add_seal(path: Path) -> None:
    """Append the checksum of all bytes of a file as its last line."""
    digest = _digest_of_bytes(path, path.stat().st_size)
    with path.open("ab") as file:
        file.write(MARK + digest + b"\n")


def is_sealed(path: Path) -> bool | None:
    """Whether the bytes of a file are those that were sealed; None where it has no seal."""
    size = path.stat().st_size - SEAL_LENGTH
    if size < 0:
        return None
    with path.open("rb") as file:
        file.seek(size)
        seal = file.read(SEAL_LENGTH)
    if not seal.startswith(MARK):
        return None
    return seal == MARK + _digest_of_bytes(path, size) + b"\n"


def _digest_of_bytes(path: Path, size: int) -> bytes:
    """SHA-256 of the first `size` bytes, as hexadecimal text."""
    digest, left = hashlib.sha256(), size
    with path.open("rb") as file:
        while left > 0:
            block = file.read(min(BLOCK, left))
            if not block:
                break
            digest.update(block)
            left -= len(block)
    return digest.hexdigest().encode()


def digest_of_data(ds: xr.Dataset) -> str:
    """SHA-256 of every variable and attribute of a dataset: names, dimensions, values; independent of file layout."""
    digest = hashlib.sha256()
    for name in sorted(map(str, ds.variables)):
        variable = ds[name]
        digest.update(repr((name, tuple(map(str, variable.dims)), variable.shape)).encode())
        digest.update(_plain_bytes(variable.values))
        digest.update(_text_of(variable.attrs))
    digest.update(_text_of(ds.attrs))
    return digest.hexdigest()


def _plain_bytes(values: NDArray[np.generic]) -> bytes:
    """Values in one byte order and width for each kind; text with its lengths."""
    if values.dtype.kind in "OUS":
        return repr([str(value) for value in values.ravel().tolist()]).encode()
    widest = {"f": "<f8", "i": "<i8", "u": "<i8", "b": "<u1"}[values.dtype.kind]
    return values.astype(widest).tobytes()


def _text_of(attributes: Mapping[object, object]) -> bytes:
    """Attributes as text, in the order of their names."""
    plain = {str(name): np.asarray(value).tolist() for name, value in attributes.items()}
    return repr(sorted(plain.items())).encode()
