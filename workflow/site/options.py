"""The page of the command's options, made from the command itself."""

import inspect
import re
from pathlib import Path

import click

from sidmacib.command.joints import joint_options
from sidmacib.command.main import main

INTRODUCTION = """# Every option of the command

The text of `multilock --help`, for all [commands](command.md).
"""
OF_A_JOINT = """
## A joint

`capacity`, `envelope`, `weights`, `law` and `joint` take these options, in SI units.
"""


def write_options(folder: Path) -> None:
    """Write the page into ``folder``."""
    (folder / "options.md").write_text(page())


def page() -> str:
    """The options of all commands: those of a joint first, which several commands share."""
    joint = click.command()(joint_options(lambda: None)).params
    names = {option.name for option in joint}
    lines = [INTRODUCTION, OF_A_JOINT, *_table(joint)]
    for name, command in sorted(main.commands.items()):
        own = [
            one
            for one in command.params
            if isinstance(one, click.Argument) or one.name not in names
        ]
        lines += ["", f"## {name}", "", inspect.cleandoc(command.help or ""), "", *_table(own)]
    return "\n".join(lines) + "\n"


def _table(parameters: list[click.Parameter]) -> list[str]:
    rows = ["| option | values | meaning |", "| --- | --- | --- |"]
    for parameter in parameters:
        rows.append("| " + " | ".join(map(_cell, _words(parameter))) + " |")
    return rows


def _words(parameter: click.Parameter) -> tuple[str, str, str]:
    """How it is typed, what it may be, and what it means."""
    values = parameter.make_metavar(click.Context(main))
    if not isinstance(parameter, click.Option):
        return f"`{parameter.human_readable_name}`", "a file", "needed"
    typed = ", ".join(f"`{name}`" for name in parameter.opts)
    if isinstance(parameter.type, click.Choice):
        values = ", ".join(f"`{choice}`" for choice in parameter.type.choices)
    meaning = parameter.help or ""
    if parameter.show_default and "[default" not in meaning:
        meaning += f"[default: {parameter.default}]"
    meaning = re.sub(r" *\[default: (.*)\]", r" Default: \1.", meaning)
    return typed, "" if parameter.is_flag else values, meaning


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")
