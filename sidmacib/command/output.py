"""Rows as a table for a terminal, as JSON, as CSV, or as a picture of V and M."""

import csv
import hashlib
import io
import json
import math
import re
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from sidmacib.command import FAULT
from sidmacib.command.answers import Row
from sidmacib.drawing import BLUE, ORANGE, vm_axes, vm_curve, write_figure
from sidmacib.errors import CapacityError, reason
from sidmacib.joint import Joint
from sidmacib.models import MODELS
from sidmacib.models.joint_answers import ERRORS
from sidmacib.quantities import MEASURED_IN, four_digits, rounded

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS = ("table", "json", "csv")
PATIENCE = 5.0  # s
SENTENCES = ("note", "notes", "answer")
SET_BY_OPTIONS = "blocks", "interfaces", "tolerance"  # sections of a structure's file
# In the context of a command: units of its answer, see `text_of`, and names that have numbers.
UNITS, NAMES = "multilock.units", "multilock.names"
# Of models, as in the figures of studies.
COLOURS = {name: model.colour for name, model in MODELS.items()}
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
_SI = sorted(MEASURED_IN, key=len, reverse=True)  # N m before N
_MEASURED = re.compile(
    rf"(?<![\w.])(?P<numbers>{_NUMBER.pattern}|\((?:{_NUMBER.pattern}(?:, )?)+\))"
    rf" (?P<unit>{'|'.join(map(re.escape, _SI))})(?![\w/²³])"
)
BLOCKS = {"upper": BLUE, "lower": ORANGE}


def with_version(about: Row) -> Row:
    """What JSON and CSV say beside rows: the version of multilock, and ``about`` by plain names."""
    return {"version": version("multilock"), **_rounded_in(plain_row(about))}


def text_of(rows: Sequence[Row], form: str, about: Row | None = None) -> str:
    """``rows`` in one of `FORMATS`, in the units that were asked for.

    JSON and CSV have the digits of records, which are the same on every processor. A column in m, N
    and so on has its unit at the end of its name: in a table in brackets, else after an underscore.
    ``about``: what JSON says beside the rows, and CSV in columns of its own: a list with
    semicolons, keys and values as JSON.
    """
    rows, beside = in_asked_units(rows), in_asked_units([about or {}])[0]
    if form != "table":
        rows, beside = _rounded_in([plain_row(row) for row in rows]), with_version(beside)
    if form == "json":
        return json.dumps({**beside, "rows": rows}, indent=1)
    if form == "csv" and about is not None:
        same = {key: _in_a_cell(value) for key, value in beside.items()}
        rows = [{**row, **same, **row} for row in rows]
    head = list(rows[0]) if rows else []
    if form == "csv":
        stream = io.StringIO()
        writer = csv.DictWriter(stream, head, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
        return stream.getvalue().rstrip("\n")
    cells = [head, *([cell(row[key]) for key in head] for row in rows)]
    widths = [max(len(line[place]) for line in cells) for place in range(len(head))]
    numeric = [all(isinstance(row[key], int | float | None) for row in rows) for key in head]
    lines = [
        "  ".join(
            text.rjust(width) if right else text.ljust(width)
            for text, width, right in zip(line, widths, numeric, strict=True)
        ).rstrip()
        for line in cells
    ]
    return "\n".join(lines)


def _rounded_in(value: Any) -> Any:
    """``value`` with all floating-point numbers in it `rounded`."""
    if isinstance(value, float):
        return rounded(value)
    if isinstance(value, dict):
        return {key: _rounded_in(each) for key, each in value.items()}
    return [*map(_rounded_in, value)] if isinstance(value, list | tuple) else value


def _in_a_cell(value: Any) -> Any:
    if isinstance(value, list):
        return "; ".join(value)
    return json.dumps(value) if isinstance(value, dict) else value


def plain_row(row: Row) -> Row:
    """The ``row`` with names as programs read them: ``load / weight`` is ``load_over_weight``."""
    return {_plain_name(name): value for name, value in row.items()}


def _plain_name(name: str) -> str:
    for words, other in (("N m", "Nm"), ("%", "percent"), (" / ", " over "), ("/", " over ")):
        name = name.replace(words, other)
    return "_".join(re.findall(r"[^\s,()]+", name))


def in_asked_units(rows: Sequence[Row]) -> list[Row]:
    """``rows`` in the units that were asked for, their notes too."""
    asked = _asked_units()

    def converted(key: str, value: Any) -> tuple[str, Any]:
        name, _, unit = key.removesuffix(")").rpartition(" (")
        if key in SENTENCES:
            many = isinstance(value, list)
            return key, [*map(in_asked_words, value)] if many else in_asked_words(value)
        if unit not in asked or not key.endswith(")"):
            return key, value
        other, size = asked[unit]
        return f"{name} ({other})", value / size if isinstance(value, int | float) else value

    return [dict(converted(key, value) for key, value in row.items()) for row in rows]


def in_asked_words(words: str) -> str:
    """``words`` with numbers and vectors in the units that were asked for, in four digits.

    Names of `keep_names` stay as they are.
    """
    asked, names = _asked_units(), _in_context(NAMES, ())

    def converted(found: re.Match[str]) -> str:
        if found["unit"] not in asked:
            return found[0]
        unit, size = asked[found["unit"]]
        numbers = _NUMBER.sub(lambda each: four_digits(float(each[0]) / size), found["numbers"])
        return f"{numbers} {unit}"

    parts = re.split(f"({'|'.join(map(re.escape, names))})", words) if names else [words]
    parts[::2] = [_MEASURED.sub(converted, part) for part in parts[::2]]
    return "".join(parts)


def keep_names(names: Iterable[str]) -> None:
    """Keep those of ``names`` in which a number has a unit, such as block "pier 2 m"."""
    measured = {name for name in names if _MEASURED.search(name)}
    click.get_current_context().meta[NAMES] = sorted(measured, key=len, reverse=True)


def _asked_units() -> Mapping[str, tuple[str, float]]:
    """The unit that was asked for in place of an SI unit, and its size."""
    found: Mapping[str, tuple[str, float]] = _in_context(UNITS, {})
    return found


def _in_context(key: str, otherwise: Any) -> Any:
    context = click.get_current_context(silent=True)
    return context.meta.get(key, otherwise) if context else otherwise


def cell(value: Any) -> str:
    """A value as tables show it."""
    if value is None:
        return "-"
    return four_digits(value) if isinstance(value, float) else str(value)


def say(words: str, form: str) -> None:
    """Print ``words`` above a table; beside any other form, on standard error.

    In the units that were asked for.
    """
    click.echo(in_asked_words(words), err=form != "table")


class Fault(click.ClickException):
    """A fault in what was given, which is no answer either."""

    exit_code = FAULT


@contextmanager
def refused_in_one_line() -> Iterator[None]:
    """Report a model's refusal of a joint or a structure, or a fault of a file, as click does.

    The exit status is 1 where a model has no answer, 2 where what was given is at fault.
    """
    try:
        yield
    except ERRORS as error:
        kind = click.ClickException if isinstance(error, CapacityError) else Fault
        raise kind(_by_flag(reason(error))) from None


def _by_flag(words: str) -> str:
    """``words`` on a key of a structure's file, by the flag of the option that set it, if any."""
    context, (key, _, fault) = click.get_current_context(silent=True), words.partition(": ")
    section, name = key.partition(".")[0], key.rpartition(".")[2]
    if context and section in SET_BY_OPTIONS and context.params.get(name):
        for each in context.command.params:
            if each.name == name and isinstance(each, click.Option):
                return f"{each.opts[0]}: {fault}"
    return words


@contextmanager
def status_line() -> Iterator[Callable[[str], object]]:
    """A function that shows a line on the terminal in place of the one before, erased at the end.

    It shows nothing where standard error is not a terminal.
    """
    if not sys.stderr.isatty():
        yield str
        return

    def show(words: str) -> None:
        click.echo(f"\r\x1b[K{words}", err=True, nl=False)

    try:
        yield show
    finally:
        show("")


@contextmanager
def told_late() -> Iterator[Callable[[str], object]]:
    """A function that tells, on standard error, what is done, if that takes `PATIENCE` or more."""
    told: list[str] = []
    lock, late = threading.Lock(), False

    def tell(*words: str) -> None:
        nonlocal late
        with lock:
            told.extend(map(in_asked_words, words))
            late = late or not words  # from the timer
            while late and told:
                # in place of what `status_line` shows
                click.echo(("\r\x1b[K" if sys.stderr.isatty() else "") + told.pop(0), err=True)

    timer = threading.Timer(PATIENCE, tell)
    timer.daemon = True
    timer.start()
    try:
        yield tell
    finally:
        timer.cancel()


@contextmanager
def writing(flag: str, path: Path) -> Iterator[None]:
    """`click.UsageError` for a file or folder, named by a ``flag``, that cannot be written."""
    try:
        yield
    except OSError as error:
        raise click.UsageError(f"{flag} {path}: {error.strerror or error}") from None


def draw(figure: "Figure", path: Path) -> None:
    """Write ``figure`` into a file whose ending tells its kind; `click.UsageError`."""
    with writing("--picture", path):
        write_figure(figure, path, dpi=150)


class Formula(str):
    """A formula in HTML, which templates take as it is."""

    __slots__ = ()

    def __html__(self) -> str:
        return self


class Appended(NamedTuple):
    """A file that a note was made from: its name, SHA-256 digest, and text if it is YAML."""

    name: str
    digest: str
    text: str

    @classmethod
    def of(cls, path: Path) -> "Appended":
        """What is in a file now."""
        data = path.read_bytes()
        text = data.decode("utf-8", "replace") if path.suffix in (".yaml", ".yml") else ""
        return cls(path.name, hashlib.sha256(data).hexdigest(), text)


def write_text(text: str, path: Path, flag: str) -> None:
    """Write ``text`` into a file named by ``flag``; `click.UsageError`."""
    with writing(flag, path):
        path.write_text(text, encoding="utf-8")


def plot(title: str, x: str, y: str, height: float = 4.0) -> "tuple[Figure, Axes]":
    """A figure with axes of this ``title`` and these labels; ``height`` in inches."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, height), layout="constrained")
    axes = figure.subplots()
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.set_title(title, loc="left", fontsize=10)
    return figure, axes


def bars(rows: Sequence[Row], title: str) -> "Figure":
    """The weight of each lock."""
    figure, axes = plot(title, "lock", "weight")
    for block, colour in BLOCKS.items():
        of_block = [row for row in rows if row["block"] == block]
        locks = [row["lock"] for row in of_block]
        weights = [row["weight"] for row in of_block]
        axes.bar(locks, weights, color=colour, label=f"{block} block")
    axes.xaxis.get_major_locator().set_params(integer=True)
    axes.legend()
    return figure


def curves(rows: Sequence[Row], title: str, note: str, *, joined: bool = True) -> "Figure":
    """V-M curves of the models in ``rows``, with a ``note`` below them.

    Points alone unless ``joined``: a line between few directions may lie above what is carried.
    """
    figure, axes = plot(title, "", "", height=4.5)
    for model in dict.fromkeys(row["model"] for row in rows):
        points = [row for row in rows if row["model"] == model and row["V (N)"] is not None]
        points.sort(key=lambda row: math.inf if row["e/a"] == "torsion" else row["e/a"])
        shear, torque = [row["V (N)"] for row in points], [row["M (N m)"] for row in points]
        line = {"marker": "o", "markersize": 3, "color": COLOURS[model]}
        line |= {} if joined else {"linestyle": "none", "markersize": 6}
        vm_curve(axes, shear, torque, model, **line)
    vm_axes(axes, title)
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    if axes.lines:
        axes.legend()
    figure.supxlabel(note, x=0.02, ha="left", fontsize=8)
    return figure


def note_of(joint: Joint) -> str:
    """Sizes of a joint whose capacities are drawn, and which of the picture is computed."""
    sizes = ", ".join(f"{name} = {1e3 * getattr(joint, name):g}" for name in ("a", "b", "h", "H"))
    return f"{sizes} mm; T0 = {four_digits(joint.T0)} N; M = V e.\nOnly the points are computed."


def require_answer(rows: Sequence[Row]) -> None:
    """End with status 1 if no model has a number."""
    if all(row[key] is None for row in rows for key in row.keys() - {"e/a", "model", "note"}):
        sys.exit(1)
