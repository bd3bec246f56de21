"""A structure: blocks, the interfaces found between them, and the law of each interface."""

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sidmacib.errors import CapacityError
from sidmacib.joint.pieces import APART
from sidmacib.mechanics.assembly import (
    Assembly,
    FaceMaterial,
    Kind,
    NodeLayout,
)
from sidmacib.mechanics.polygons import CondensedLocks, Polygon, polygon_nodes
from sidmacib.problem import Problem
from sidmacib.quantities import some_of
from sidmacib.structure.blocks import Block, Compound, grouped, solids_of
from sidmacib.structure.interfaces import (
    NEAR,
    Interface,
    interfaces,
    joined,
    mean_size,
    touching,
)
from sidmacib.structure.locks import (
    ALL,
    Condensed,
    Locks,
    Row,
    condensed_points,
    cut_rows,
    rule_limits,
)
from sidmacib.validation import refused

MOST_CELLS = 200_000  # of all interfaces
LOCK = re.compile(r"-lock\d+$")  # ends the name of a lock that was cut out
Pair = frozenset[str]  # names of two blocks


def structure(
    blocks: Sequence[Block],
    material: FaceMaterial,
    special: Mapping[Pair, FaceMaterial] | None = None,
    locked: Mapping[Pair, Locks] | None = None,
    *,
    mesh: float = math.inf,
    nodes: NodeLayout | None = None,
    near: float = NEAR,
    regions: Sequence[Interface] | None = None,
) -> Assembly:
    """The assembly of ``blocks`` with an interface wherever two of them touch.

    ``material``: of all interfaces but those between pairs of blocks in ``special``. One with
    cohesion or tensile strength is bonded, any other dry. ``locked``: the locks of pairs of convex
    blocks that touch in one region. ``nodes`` on cells no longer than ``mesh`` (m); without one, a
    convex interface is one cell; by default Lobatto's, which integrate the stresses of bonds
    exactly, or vertices if everything is dry. ``near``: see `interfaces`. ``regions``: interfaces
    in place of those that are found. ValueError for two blocks of one name, a pair that does not
    touch, or no free block.
    """
    names = [block.name for block in blocks]
    _require_once(names, "each name once")
    free = [block.size for block in blocks if not block.fixed]
    if not free:
        raise ValueError("blocks: at least one must be free to move")
    special = dict(special or {})
    found = interfaces(blocks, near) if regions is None else tuple(regions)
    _require_touching("special", special, [each.pair(blocks) for each in found])
    for pair in special.keys() & (locked or {}).keys():
        allowed = "two blocks without locks, which have materials of their own"
        raise refused("special", " and ".join(sorted(pair)), allowed)
    rows = rows_of(blocks, locked or {}, found)
    parts = parts_of(blocks, rows)
    pieces = tuple(part.piece for part in parts)
    solids = [(number, each) for number, piece in enumerate(pieces) for each in solids_of(piece)]
    if len(solids) > len(blocks):
        numbers, every = zip(*solids, strict=True)
        found = joined(touching(every, near), numbers, near * mean_size(every))
    _require_once([piece.name for piece in pieces], "a name that no lock has")
    _require_held(pieces, found)
    area = math.fsum(each.outline.area for each in found)
    if area / mesh / mesh > MOST_CELLS:  # before they are made
        least = math.sqrt(area / MOST_CELLS)
        raise refused("mesh", mesh, f"at least {least:.2g} m: more than {MOST_CELLS:,} cells")
    faces = tuple(_faces(found, parts, material, special, rows))
    if nodes is None:
        bonded = any(face.kind is Kind.INNER for face in faces)
        nodes = NodeLayout.LOBATTO if bonded else NodeLayout.VERTICES
    of_faces = polygon_nodes(faces, mesh, nodes)
    length = float(np.mean(free))
    opening = min((APART * row.locks.height for row in rows.values()), default=math.inf)
    return Assembly(
        *(pieces, faces, of_faces, length),
        mesh=mesh,
        layout=nodes,
        most_opening=opening,
    )


def _require_once(names: Sequence[str], allowed: str) -> None:
    for name, count in Counter(names).items():
        if count > 1:
            raise refused("blocks", name, allowed)


def _require_held(pieces: Sequence[Block | Compound], found: Sequence[Interface]) -> None:
    """ValueError, with their names, for free pieces that no interfaces link to a fixed one."""
    ends = np.array([(each.below, each.above) for each in found], np.int64).reshape(-1, 2)
    group = grouped(len(pieces), ends)
    held = {group[number] for number, piece in enumerate(pieces) if piece.fixed}
    if not held:
        raise ValueError(
            "blocks: none is fixed; use --fixed NAMES or --fixed-below HEIGHT, or fixed: true in a "
            "YAML file, of the same name as a file of blocks"
        )
    loose = [piece.name for piece, of in zip(pieces, group, strict=True) if of not in held]
    if loose:
        raise ValueError(f"{some_of(loose, 3)}: must be linked to a fixed block")


def refined(assembly: Assembly, divided: int = 2, *, pressed: bool = True) -> Assembly:
    """The structure on cells of half the size, or ``divided`` otherwise, for an answer.

    Pressure on dry faces is integrated; unless ``pressed`` it is at the nodes, as in the engines.
    Of the structure of a file, not of a refined one: without a mesh, its cells are the interfaces.
    """
    faces = tuple(face for face in assembly.faces if isinstance(face, Polygon))
    nodes = polygon_nodes(faces, assembly.mesh, assembly.layout, divided, pressed=pressed)
    return replace(assembly, nodes=nodes, mesh=assembly.mesh / divided)


def rows_of(
    blocks: Sequence[Block], locked: Mapping[Pair, Locks], found: Sequence[Interface]
) -> dict[Pair, Row]:
    """Where the locks of each pair are on the interfaces ``found``.

    ValueError for a pair that does not touch, or not in one region, and for locks without room.
    """
    pairs = [each.pair(blocks) for each in found]
    _require_touching("locks", locked, pairs)
    rows = {}
    for pair, locks in locked.items():
        name = f"locks of {' and '.join(sorted(pair))}"
        here = [each for each, ends in zip(found, pairs, strict=True) if ends == pair]
        if len(here) != 1 or len(here[0].outline.interiors):
            raise ValueError(f"{name}: the blocks must touch in one region without a hole")
        if locks.first is not None and locks.first not in pair:
            raise refused(f"{name}: first", locks.first, "one of the two blocks")
        first = locks.first or blocks[here[0].below].name
        rows[pair] = Row.of(replace(locks, first=first), here[0], name)
    return rows


def _require_touching(key: str, given: Iterable[Pair], pairs: Sequence[Pair]) -> None:
    for pair in given:
        if pair not in pairs:
            raise refused(key, " and ".join(sorted(pair)), "two blocks that touch")


@dataclass(frozen=True)
class Part:
    """A piece that blocks are cut into, and the name of the block that it belongs to.

    ``row``: of a lock the pair of its blocks.
    """

    piece: Block | Compound
    owner: str
    row: Pair | None = None


def parts_of(blocks: Sequence[Block], rows: Mapping[Pair, Row]) -> list[Part]:
    """``blocks`` with the locks of ``rows`` that are not condensed cut out."""
    cut = {pair: row for pair, row in rows.items() if not row.locks.condensed}
    left, parts = cut_rows(blocks, cut.values())
    found = [Part(_piece(name, solids), name) for name, solids in left.items()]
    density = {block.name: block.density for block in blocks}
    for (pair, row), (in_below, in_above) in zip(cut.items(), parts, strict=True):
        below, above = (blocks[end].name for end in (row.interface.below, row.interface.above))
        for number in range(row.locks.count):
            other = above if row.locks.first == below else below
            owner = str(row.locks.first if number % 2 == 0 else other)
            name = f"{below}-{above}-lock{number + 1}"
            own = [
                replace(part.solid, name=name, density=density[owner], fixed=False)
                for part in (*in_below, *in_above)
                if part.number == number
            ]
            if not own:
                raise ValueError(f"{name}: has no part of the blocks; use fewer locks")
            found.append(Part(_piece(name, own), owner, pair))
    return found


def _piece(name: str, solids: Sequence[Block]) -> Block | Compound:
    return solids[0] if len(solids) == 1 else Compound(name, tuple(solids), solids[0].fixed)


def _faces(
    found: Sequence[Interface],
    parts: Sequence[Part],
    material: FaceMaterial,
    special: Mapping[Pair, FaceMaterial],
    rows: Mapping[Pair, Row],
) -> Iterator[Polygon]:
    """The faces between pieces, each with its law and a name of its own."""
    count: Counter[str] = Counter()
    for each in found:
        ends = each.below, each.above
        name = "-".join(parts[end].piece.name for end in ends)
        count[name] += 1
        name += f"-{count[name]}" if count[name] > 1 else ""
        one, other = (parts[end].owner for end in ends)
        pair = frozenset((one, other))
        row = rows.get(pair)
        kind, law = Kind.DRY, special.get(pair, material)
        if one == other:  # a lock and its own block, or two locks of it
            of_lock = next(filter(None, (parts[end].row for end in ends)))
            kind, law = Kind.INNER, rows[of_lock].locks.inner
        elif row and row.locks.condensed:
            solids = [parts[end].piece for end in ends]
            yield _condensed(row, row.locks.condensed, solids, name)
            continue
        elif row:
            law = row.locks.dry
        elif law.cohesion > 0.0 or law.tensile_strength > 0.0:
            kind = Kind.INNER
        yield Polygon(name, kind, law, *ends, each.axes, each.middle, each.outline)


def _condensed(
    row: Row, condensed: Condensed, solids: Sequence[Block | Compound], name: str
) -> CondensedLocks:
    """The face of locks that are condensed: as strong as those that work."""
    locks, each = row.locks, row.interface
    share = min(condensed.working or ALL, locks.count) / locks.count
    law = replace(locks.inner, cohesion=share * locks.inner.cohesion, friction=locks.dry.friction)
    axes = np.array([each.axes[0], row.run, row.across])
    ends, points = (each.below, each.above), condensed_points(row, condensed.option)
    limits = None
    if condensed.rule is not None:
        limits = rule_limits(row, condensed.rule, condensed.hold_down, solids, name)
    return CondensedLocks(
        name, Kind.LOCKED, law, *ends, axes, each.middle, row.outline, *points, limits
    )


def owners_of(assembly: Assembly) -> list[int]:
    """For each piece its number, or that of the block which it is a lock of."""
    is_lock = [bool(LOCK.search(piece.name)) for piece in assembly.pieces]
    owners = list(range(len(is_lock)))
    for face in assembly.faces:
        for lock, block in ((face.below, face.above), (face.above, face.below)):
            if face.kind is Kind.INNER and is_lock[lock] and not is_lock[block]:
                owners[lock] = block
    return owners


def with_dry_joints(problem: Problem) -> Problem:
    """The ``problem`` without bonds; `CapacityError` for locks, which are nothing without them."""
    assembly = problem.assembly
    if owners_of(assembly) != list(range(len(assembly.pieces))):
        raise CapacityError("locks need their bonds")
    faces = tuple(
        replace(
            face,
            kind=Kind.DRY,
            material=replace(face.material, cohesion=0.0, tensile_strength=0.0),
        )
        if face.kind is Kind.INNER
        else face
        for face in assembly.faces
    )
    return problem._replace(assembly=replace(assembly, faces=faces))
