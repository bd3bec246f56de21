"""What limit analysis answers for a structure, on the cells of its file.

Apart from the static model's answers, so that following a path loads no solver of programmes.
"""

from sidmacib.mechanics.assembly import Assembly, Kind, Loads
from sidmacib.mechanics.limit import LimitState, limit_load, require_standing
from sidmacib.mechanics.polygons import CondensedLocks
from sidmacib.structure.loads import naming_permanent


def limit_state(assembly: Assembly, loads: Loads, most: float | None = None) -> LimitState:
    """The state at the largest load that forces can balance, or at ``most`` (N), with friction.

    `sidmacib.errors.CapacityError` if there is none, or if the structure does not stand.
    """
    with naming_permanent(loads):
        require_standing(assembly, loads, friction=True)
        return limit_load(assembly, loads, friction=True, most=most)


def assumes(assembly: Assembly) -> str:
    """What limit analysis assumes that may put its load too high or too low."""
    if any(isinstance(face, CondensedLocks) and face.limits for face in assembly.faces):
        return "locks limited by the rule, held down as given; the first lock to fail governs"
    if any(face.kind is Kind.INNER for face in assembly.faces):
        return "ductile, frictionless bonds: neither an upper nor a lower bound for brittle bonds"
    return "associated friction: may overestimate"
