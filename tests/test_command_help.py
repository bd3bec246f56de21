"""The help of the command: groups of options, long names, and a width of 80 columns."""

import re

import pytest
from command_runner import answers, run

from sidmacib.command.main import main
from sidmacib.command.options import GROUPS, Grouped

COLUMNS = 80


@pytest.mark.parametrize("command", ["", *main.commands])
def test_no_line_of_the_help_is_wider_than_a_terminal(command: str) -> None:
    found = run(*filter(None, [command]), "--help")
    assert all(len(line) <= COLUMNS for line in found.output.splitlines())


def test_no_summary_is_cut_off_in_the_list_of_commands() -> None:
    listed = run("--help").output.partition("Commands:\n")[2]
    assert len(listed.splitlines()) == len(main.commands)
    assert "..." not in listed


@pytest.mark.parametrize("command", ["capacity", "envelope", "weights", "sensitivity", "joint"])
def test_options_stand_under_the_heading_of_their_group(command: str) -> None:
    parts = re.split(r"^(\S.*):\n(?=  )", run(command, "--help").output, flags=re.MULTILINE)
    under = dict(zip(parts[1::2], parts[2::2], strict=True))
    assert [group for group in GROUPS if group in under] == [*under]
    for option in main.commands[command].params:
        if isinstance(option, Grouped):
            assert re.search(rf"^  {option.opts[0]}\b", under[option.group], re.MULTILINE)


def test_sizes_have_long_names() -> None:
    short = answers("law", "-n", "7", "-a", "0.08", "-b", "0.04", "-h", "0.01", "-H", "0.06")
    sizes = ("--length", "0.08", "--width", "0.04", "--height", "0.01", "--body-height", "0.06")
    assert answers("law", "--locks", "7", *sizes) == short
