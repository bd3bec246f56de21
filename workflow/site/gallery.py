"""The gallery of the site: a page with picture, output and code for each script of `docs/gallery`.

A script's docstring is the title and text of its page, and its picture has its name. Scripts run
when the site is built, in a process each, as a reader would run them.
"""

import ast
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

CHECKOUT = Path(__file__).parents[2]
INDEX = """# Gallery

Short scripts, each with its picture and the numbers that it prints. Download one and run it where
the library is installed. The notebook {download}`first_joint.ipynb <../first_joint.ipynb>` does the
same step by step.
"""


@dataclass(frozen=True)
class Example:
    """A script of the gallery: its ``name``, ``title``, text in Markdown, and code."""

    name: str
    title: str
    text: str
    code: str


def examples(folder: Path) -> list[Example]:
    """All scripts in ``folder``, by title; ValueError for one whose docstring has no text."""
    found = [read(path) for path in folder.glob("*.py")]
    return sorted(found, key=lambda example: example.title)


def read(path: Path) -> Example:
    """An example, with its docstring apart from its code."""
    source = path.read_text()
    first, *_ = ast.parse(source).body
    title, _, text = (ast.get_docstring(ast.parse(source)) or "").partition("\n\n")
    if not text:
        raise ValueError(f"{path}: the docstring must have a title and text")
    code = "".join(source.splitlines(keepends=True)[first.end_lineno :])
    return Example(path.stem, title, text, code.strip("\n"))


def run(folder: Path, name: str, made: Path) -> str:
    """What script ``name`` of ``folder`` prints; its picture is written into ``made``."""
    found = os.environ.get("PYTHONPATH")
    paths = os.pathsep.join([str(CHECKOUT), *([found] if found else [])])
    done = subprocess.run(
        [sys.executable, str(folder / f"{name}.py")],
        cwd=made,
        env={**os.environ, "PYTHONPATH": paths, "MPLBACKEND": "Agg", "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(f"{folder / name}.py failed:\n{done.stderr}")
    return done.stdout


def page(example: Example, printed: str) -> str:
    """The page of an example."""
    name = example.name
    return f"""# {example.title}

{example.text}

![{example.title}]({name}.png)

It prints

```text
{printed.rstrip()}
```

{{download}}`{name}.py <../{name}.py>`:

```python
{example.code}
```
"""


def index(found: list[Example]) -> str:
    """The page with all pictures, each of which leads to its page."""
    return "\n".join([INDEX, "`````{container} gallery", *_cards(found), "`````", *_toctree(found)])


def _cards(found: list[Example]) -> Iterator[str]:
    for example in found:
        yield f"[![]({example.name}.png) {example.title}]({example.name}.md)\n"


def _toctree(found: list[Example]) -> list[str]:
    names = [example.name for example in found]
    return ["", "```{toctree}", ":hidden:", "", *names, "```", ""]


def write_gallery(folder: Path) -> None:
    """Write ``made/`` of ``folder``; a script runs only if it or the library has changed since."""
    made = folder / "made"
    made.mkdir(exist_ok=True)
    found = examples(folder)
    library = max(path.stat().st_mtime for path in (CHECKOUT / "sidmacib").rglob("*.py"))
    for example in found:
        target = made / f"{example.name}.md"
        newest = max(library, (folder / f"{example.name}.py").stat().st_mtime)
        if not target.exists() or target.stat().st_mtime < newest:
            target.write_text(page(example, run(folder, example.name, made)))
    (made / "index.md").write_text(index(found))
