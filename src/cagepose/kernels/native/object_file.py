"""Machine code on disk: what a linker takes, with a checksum before it.

A process may be killed while it writes, and several may write at once: each writes a file of its own and gives it its
name at the end. What cannot be read, or is not what was written, is as good as no file.
"""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_CHECKSUM_BYTES = hashlib.sha256().digest_size


@dataclass(frozen=True)
class ObjectFile:
    """Machine code of one function.

    Attributes
    ----------
    name
        Of the function.
    results
        What it returns, see `cagepose.kernels.native.c_function`.
    code
        As a linker takes it.
    """

    name: str
    results: Any
    code: bytes

    def write(self, path: Path) -> None:
        """Write it, if the disk lets us: the next process compiles it anew otherwise."""
        content = json.dumps([self.name, self.results]).encode() + b"\n" + self.code
        draft = path.with_name(f".{path.name}.{os.urandom(8).hex()}")
        try:
            draft.write_bytes(hashlib.sha256(content).digest() + content)
            draft.replace(path)
        except OSError:
            draft.unlink(missing_ok=True)


def read_object_file(path: Path) -> ObjectFile | None:
    """Return what was written, or None."""
    try:
        found = path.read_bytes()
    except OSError:
        return None
    checksum, content = found[:_CHECKSUM_BYTES], found[_CHECKSUM_BYTES:]
    if hashlib.sha256(content).digest() != checksum:
        return None
    head, _, code = content.partition(b"\n")
    name, results = json.loads(head)
    return ObjectFile(name, results, code)
