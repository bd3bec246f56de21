"""Options under headings in the help of a command."""

from typing import Any

import click

# In the order of the help; options without a group come first.
OWN, LOAD, GEOMETRY, MATERIAL, OUTPUT = "Options", "Load", "Geometry", "Material", "Input, output"
GROUPS = (OWN, LOAD, GEOMETRY, MATERIAL, OUTPUT)


class Grouped(click.Option):
    """An option under one of the `GROUPS`."""

    def __init__(self, *names: Any, group: str, **more: Any) -> None:
        super().__init__(*names, **more)
        self.group = group


class GroupedCommand(click.Command):
    """A command whose help has its options under their headings."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options, group by group."""
        found: dict[str, list[tuple[str, str]]] = {group: [] for group in GROUPS}
        for param in self.get_params(ctx):
            record = param.get_help_record(ctx)
            if record is not None:
                found[getattr(param, "group", OWN)].append(record)
        for group, records in found.items():
            if records:
                with formatter.section(group):
                    formatter.write_dl(records)
