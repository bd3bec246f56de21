"""Receipts: the outputs of a job and its inputs, compared with the results at every start.

A receipt holds a digest of each of the job's outputs, and a digest of everything that the job
depends on: its arguments, the code that it runs, the versions of the programs that it starts.
If an output is missing, or is not what the job made, the job is run again. Receipts hold no times
and no absolute paths: a results folder can be moved.
"""

import errno
import hashlib
import json
import os
import stat
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from io import BufferedReader
from pathlib import Path
from typing import Any

STALE = "made from something else"


@dataclass(frozen=True)
class Receipt:
    """``digest``: of what the job depends on. ``outputs``: digests of its files, by path."""

    job: str
    digest: str
    outputs: dict[str, str]


def digest_of(value: Any) -> str:
    """Digest of plain data, the same for equal data."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def file_digest(path: Path) -> str:
    """Digest of a file's contents; OSError for a pipe, a device or a folder in its place."""
    with opened(path) as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def opened(path: Path) -> BufferedReader:
    """A regular file, opened for reading; OSError for a pipe, a device or a folder."""
    number = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise OSError(errno.EINVAL, "not a file", str(path))
    return os.fdopen(number, "rb")


def write_receipt(path: Path, job: str, digest: str, results: Path, outputs: Iterable[str]) -> None:
    """Write the receipt of a job that has ended well."""
    made = {name: file_digest(results / name) for name in outputs}
    write_whole(path, json.dumps(asdict(Receipt(job, digest, made)), indent=1) + "\n")


def write_whole(path: Path, text: str) -> None:
    """Write a file atomically: a reader finds the old content or all of ``text``."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(path.name + ".draft")
    draft.unlink(missing_ok=True)  # it may be a link
    draft.write_text(text)
    draft.replace(path)


def read_receipt(path: Path) -> Receipt | None:
    """The receipt at ``path``; None if it is missing or cannot be read."""
    try:
        with opened(path) as stream:
            data: Mapping[str, Any] = json.loads(stream.read())
        return Receipt(str(data["job"]), str(data["digest"]), dict(data["outputs"]))
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return None


def fault(
    receipt: Receipt | None,
    job: str,
    digest: str,
    results: Path,
    outputs: Iterable[frozenset[str]],
) -> str | None:
    """Why the results of ``job`` must be made again, in a few words; None if they are valid.

    ``outputs``: which files a receipt may name, all of them.
    """
    if receipt is None:
        return "never made"
    if receipt.job != job:
        return "made by another job"
    if frozenset(receipt.outputs) not in outputs:
        return "a receipt of other files"
    for name, content in receipt.outputs.items():
        try:
            if file_digest(results / name) != content:
                return f"{name} was changed"
        except OSError:
            return f"{name} is gone"
    return None if receipt.digest == digest else STALE
