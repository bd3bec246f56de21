"""What limit analysis, kinematics and the static model answer where a support moves."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from sidmacib.errors import CapacityError
from sidmacib.mechanics.assembly import Assembly
from sidmacib.quantities import some_of
from sidmacib.structure.analysis.support_path import static_reactions
from sidmacib.structure.analysis.supports import (
    SupportPath,
    greatest_reaction,
    least_reaction,
    support_path,
)
from sidmacib.structure.loads import SupportMotion

MOST_JOINTS = 6  # names in a note


@dataclass(frozen=True)
class SupportAnswer:
    """A reaction (N or N m) in an ``answer`` of a model, after a movement (m or rad), and a note.

    Each is None where there is none.
    """

    answer: str
    reaction: float | None
    movement: float | None
    note: str


def support_answers(
    assembly: Assembly, loads: SupportMotion
) -> tuple[list[SupportAnswer], SupportPath]:
    """The answers, and the reaction over the movement.

    `CapacityError` if the structure does not stand, or an interface is not dry.
    """
    least, path = least_reaction(assembly, loads), support_path(assembly, loads)
    greatest = greatest_reaction(assembly, loads)
    yields = f"the support yields; {joints_in_words(least.hinges, least.slides)}"
    pushed = "no limit: the support can be pushed back with any force"
    if greatest:
        joints = joints_in_words(greatest.hinges, greatest.slides)
        pushed = f"the support is pushed back; {joints}"
    last = float(path.reaction[-1]), float(path.movement[-1])
    return [
        *_static(assembly, loads, least.size),
        SupportAnswer("limit, least", least.size, None, yields),
        SupportAnswer("limit, greatest", greatest.size if greatest else None, None, pushed),
        SupportAnswer("kinematics", *last, _end(path)),
    ], path


def _static(assembly: Assembly, loads: SupportMotion, least: float) -> Iterator[SupportAnswer]:
    try:
        found = static_reactions(assembly, loads, least)
    except CapacityError as error:
        yield SupportAnswer("static", None, None, " ".join(str(error).split()))
        return
    at_rest = "elastic joints; small displacements"
    yield SupportAnswer("static, at rest", found.rest, 0.0, at_rest)
    reached = "has dropped to" if found.dropped(least) else "is followed to"
    last = float(found.reaction[-1]), float(found.movement[-1])
    yield SupportAnswer("static, yields", *last, f"the reaction {reached} this")


def _end(path: SupportPath) -> str:
    if path.falls:
        return f"the structure falls; {joints_in_words(path.hinges, path.slides)}"
    if path.free:
        return "the support carries nothing more: the structure stands without it"
    if path.path.met:
        return f"{' and '.join(path.path.met)} meet; it was followed no further"
    return "the structure still stands; it was followed no further"


def joints_in_words(hinges: Sequence[str], slides: Sequence[str]) -> str:
    """Names of hinges and of joints that slide."""
    both = [
        f"{words} {some_of(names, MOST_JOINTS)}"
        for words, names in (("hinges at", hinges), ("sliding at", slides))
        if names
    ]
    return ", ".join(both) or "no joint opens or slides"
