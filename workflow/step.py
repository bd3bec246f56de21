"""A step of a study: what the script of a rule does around its work, and the code that it runs.

That code is the modules of this project that the script imports, directly or not. Imports are read
from the compiled code, including those inside functions and `importlib.import_module` of a name, so
nothing is listed by hand. A module counts by its compiled code, which Python keeps: comments and
layout do not matter, and another version of Python runs everything again.
"""

import atexit
import ctypes
import hashlib
import json
import os
import shutil
import signal
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from importlib.machinery import SourceFileLoader
from importlib.util import resolve_name
from modulefinder import ModuleFinder
from opcode import opmap
from pathlib import Path
from types import CodeType
from typing import Any

import __main__

ROOT = Path(__file__).parents[1]
PACKAGES = ("sidmacib", "workflow", "analysis", "studies")
NOTE = "note"  # input of each job: what is asked of it
IMPORT = opmap["IMPORT_NAME"]
PR_SET_PDEATHSIG = 1

Arguments = Mapping[str, Any]
Files = Mapping[str, Path]
FileLists = Mapping[str, list[Path]]
Run = Callable[[Arguments, Any, Any], str | None]


class KilledError(SystemExit):
    """A program that the job started was killed from outside; a cluster may try again."""


def step(run: Run, **others: Run) -> None:
    """Call ``run`` with the parameters, inputs and outputs of the job that runs this script.

    ``others``: what the jobs of other rules call in its place, by the name of the rule. A ``run``
    takes parameters and resources by name, and paths by name: each a path or a list of paths. It
    may return why a case has no result, which its outputs say too. All that is printed goes to the
    job's log. The job ends with the process that started it, however that ends, and with ^C, which
    waits until the script has been loaded.
    """
    job = __main__.snakemake  # which Snakemake puts there
    run = others.get(job.rule, run)
    _end_with_parent()
    log = os.open(job.log[0], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)
    for stream in (1, 2):
        os.dup2(log, stream)
    arguments = {**dict(job.resources.items()), **dict(job.params.items())}
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        error = run(arguments, _paths(job.input), _paths(job.output))
    except KeyboardInterrupt:
        sys.exit("stopped")
    if error:
        print(error, file=sys.stderr)
        if not all(Path(path).exists() for path in job.output):
            sys.exit(1)


def _end_with_parent() -> None:
    """Have the system end this process when the one that started it ends."""
    parent = os.getppid()
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != parent:  # it has ended in the meantime
        sys.exit("stopped")


def _paths(files: Any) -> dict[str, Any]:
    return {
        name: Path(value) if isinstance(value, str) else [Path(path) for path in value]
        for name, value in files.items()
        if name != NOTE
    }


def noted(path: Path, asked: Mapping[str, Any], runs: bool) -> str:
    """A file with a digest of what is ``asked`` of a job: ``path``, where that is there.

    Else it is written, so that it is newer than what the job made; elsewhere, and for this process
    only, unless the study ``runs``.
    """
    text = _digest(json.dumps(asked, sort_keys=True, default=repr).encode()) + "\n"
    with suppress(OSError):
        if path.read_text() == text:
            return str(path)
    if not runs:
        path = Path(_scratch(), *path.parts[path.is_absolute() :])
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return str(path)


@cache
def _scratch() -> str:
    """A folder that is removed at the end of this process."""
    folder = tempfile.mkdtemp(prefix="multilock-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


@cache
def closure(module: str) -> frozenset[str]:
    """Names of all modules of this project that importing ``module`` and calling it may run."""
    found: set[str] = set()
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting.extend(_parents(name))
            waiting.extend(_imports(name))
    return frozenset(found)


def code_digest(modules: Iterable[str], files: Iterable[str] = ()) -> str:
    """Digest of all code that ``modules`` may run, and of ``files``, paths below `ROOT`."""
    names = sorted(set().union(*map(closure, modules)))
    parts = [f"{name} {_code_digest(name)}" for name in names]
    parts += [f"{name} {_digest((ROOT / name).read_bytes())}" for name in sorted(files)]
    return _digest("\n".join(parts).encode())


@cache
def source(module: str) -> Path | None:
    """The file of a module of this project; None for any other module."""
    if module.split(".", maxsplit=1)[0] not in PACKAGES:
        return None
    path = ROOT.joinpath(*module.split("."))
    candidates = (path / "__init__.py", path.with_suffix(".py"))
    return next((found for found in candidates if found.is_file()), None)


def _parents(module: str) -> Iterator[str]:
    """The packages that a module is in, but for those without a file of their own."""
    parts = module.split(".")
    return filter(source, (".".join(parts[:count]) for count in range(1, len(parts))))


@cache
def _imports(module: str) -> tuple[str, ...]:
    names: list[str] = []
    scan = ModuleFinder().scan_opcodes
    is_package = str(source(module)).endswith("__init__.py")
    package = module if is_package else module.rpartition(".")[0]
    for code in _functions(module):
        if "import_module" in code.co_names:
            names += [text for text in code.co_consts if isinstance(text, str)]
        if IMPORT not in code.co_code[::2]:
            continue
        for what, found in scan(code):
            if what != "store":
                *level, imported, base = found
                base = resolve_name("." * sum(level) + base, package)
                # A name imported from a package may be one of its modules.
                names += [base, *(f"{base}.{name}" for name in imported or ())]
    return tuple(name for name in dict.fromkeys(names) if source(name))


@cache
def _functions(module: str) -> tuple[CodeType, ...]:
    """The code of a module and of all its functions, compiled, as Python keeps it for imports."""
    path = source(module)
    assert path is not None, f"{module}: not a module of this project"
    whole = SourceFileLoader(module, str(path)).get_code(module)
    return tuple(_nested(whole)) if whole else ()


def _nested(code: CodeType) -> Iterator[CodeType]:
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _nested(constant)


@cache
def _code_digest(module: str) -> str:
    return _digest(repr([*map(_text, _functions(module))]).encode())


def _text(code: CodeType) -> tuple[object, ...]:
    """What the code of a function does, without its place in the file."""
    constants = [
        # Sets have another order in each process.
        sorted(map(repr, value)) if isinstance(value, frozenset) else repr(value)
        for value in code.co_consts
        if not isinstance(value, CodeType)
    ]
    names = code.co_names, code.co_varnames, code.co_cellvars, code.co_freevars
    return code.co_name, code.co_flags, code.co_code, code.co_exceptiontable, names, constants


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
