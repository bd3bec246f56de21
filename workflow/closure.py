"""The code that a step runs: the modules of this project that it imports, directly or not.

Imports are read from the source, including those inside functions, so nothing is listed by hand. A
module counts by its syntax tree: comments and layout do not matter.
"""

import ast
import hashlib
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.util import resolve_name
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("sidmacib", "workflow", "analysis", "studies")


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
    parts = [f"{name} {_tree_digest(name)}" for name in names]
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
    is_package = str(source(module)).endswith("__init__.py")
    package = module if is_package else module.rpartition(".")[0]
    for node in _statements(_tree(module)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = resolve_name("." * node.level + (node.module or ""), package)
            names.append(base)
            # A name imported from a package may be one of its modules.
            names += [f"{base}.{alias.name}" for alias in node.names]
    return tuple(name for name in dict.fromkeys(names) if source(name))


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """All statements below ``node``, except those for type checkers only."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.expr):  # no import is in there, and most nodes are
            continue
        if not (isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING"):
            yield child
            yield from _statements(child)


@cache
def _tree(module: str) -> ast.Module:
    path = source(module)
    assert path is not None, f"{module}: not a module of this project"
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


@cache
def _tree_digest(module: str) -> str:
    return _digest(ast.dump(_tree(module)).encode())


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
