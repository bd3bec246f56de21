"""What limit analysis answers for a structure, on the cells of its file.

Apart from the static model's answers, so that following a path loads no solver of programmes.
"""

from sidmacib.mechanics.assembly import Assembly, Kind, Loads
from sidmacib.mechanics.limit import LimitState, limit_load, require_standing
from sidmacib.mechanics.polygons import CondensedLocks


def limit_state(assembly: Assembly, loads: Loads, most: float | None = None) -> LimitState:
    """The state at the largest load that forces can balance, or at ``most`` (N), with friction.

    `sidmacib.errors.CapacityError` if there is none, or if the structure does not stand.
    """
    require_standing(assembly, loads, friction=True)
    return limit_load(assembly, loads, friction=True, most=most)


def assumes(assembly: Assembly) -> str:
    """What limit analysis assumes that may put its load too high or too low."""
    if any(isinstance(face, CondensedLocks) and face.limits for face in assembly.faces):
        return (
            "locks as a rule allows where they are held down as given; first lock to fail decides"
        )
    if any(face.kind is Kind.INNER for face in assembly.faces):
        return "bonds yield and never rub: no bound for brittle ones"
    return "associated friction: may overestimate"
