"""What the safe rule says of the locks of each interface, where it can say anything."""

from sidmacib.design.layouts import Layout
from sidmacib.errors import CapacityError
from sidmacib.joint.joint import Block, Direction, Joint, OwnLock, UpperBody
from sidmacib.mechanics.assembly import Assembly
from sidmacib.mechanics.polygons import Polygon
from sidmacib.rule.law import safe
from sidmacib.structure.blocks import Block as Solid

NOTHING = 1e-9  # over the strength of locks: forces below are none


def safe_share(
    assembly: Assembly, face: Polygon, layout: Layout, across: float, torque: float
) -> tuple[float | None, str]:
    """The force across locks (N) over what the safe rule allows them, with a ``torque`` (N m).

    The interface as a `Joint` whose upper body is the smaller of the two blocks, held down by a
    plate. None, and why, where the rule says nothing.
    """
    if abs(across) <= NOTHING * layout.strength:
        return None, "no force across"
    solids = [assembly.pieces[end] for end in (face.below, face.above)]
    height = min(each.volume / face.area for each in solids if isinstance(each, Solid))
    margin = OwnLock(width=layout.widths[0])
    length = face.area / sum(layout.widths)
    try:
        joint = Joint(
            len(layout.widths),
            a=length,
            b=layout.width,
            h=layout.kind.height,
            H=height,
            density=max(each.density for each in solids if isinstance(each, Solid)),
            inner=layout.kind.inner,
            dry=layout.kind.dry,
            upper_body=UpperBody.MONOLITHIC,
            first=Block.LOWER,
            different={1: margin, len(layout.widths): margin},
        )
        allowed = safe(joint, Direction(abs(torque / across) / length)).shear
    except (CapacityError, ValueError) as error:
        return None, " ".join(str(error).split())
    return abs(across) / allowed, ""
