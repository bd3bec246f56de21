"""The joint on the page: its parameters, and how they are written as file, as Python, as a link."""

import math
from dataclasses import asdict, dataclass, replace
from typing import Any
from urllib.parse import parse_qsl, urlencode

from sidmacib.hold_down import HoldDown
from sidmacib.joint import DRY, INNER, Joint, UpperBody
from sidmacib.mechanics.assembly import Elastic


@dataclass(frozen=True)
class Playing:
    """What the sliders say. Lengths in mm, stresses in kPa, E in GPa (0: rigid), e over a."""

    locks: int = 5
    a: float = 60.0
    b: float = 50.0
    h: float = 8.0
    H: float = 27.0
    cohesion: float = 80.0
    friction: float = 0.3
    young: float = 0.0
    pressure: float = 0.0
    eccentricity: float = 0.3
    one_piece: bool = False

    @property
    def joint(self) -> Joint:
        """The joint; pressure 0 stands for the fixed plate. ValueError as for a `Joint`."""
        return Joint(
            self.locks,
            a=self.a / 1e3,
            b=self.b / 1e3,
            h=self.h / 1e3,
            H=self.H / 1e3,
            inner=replace(
                INNER,
                cohesion=1e3 * self.cohesion,
                tensile_strength=1e3 * self.cohesion * INNER.tensile_strength / INNER.cohesion,
            ),
            dry=replace(DRY, friction=self.friction),
            elastic=Elastic(1e9 * self.young) if self.young else None,
            upper_body=UpperBody.MONOLITHIC if self.one_piece else UpperBody.COLUMNS,
            hold_down=HoldDown.pressure(1e3 * self.pressure) if self.pressure else HoldDown.plate(),
        )


def as_query(state: Playing) -> str:
    """The part of a link behind ``?``: what is not as at first."""
    told = {k: v for k, v in asdict(state).items() if v != getattr(Playing(), k)}
    return urlencode({key: int(value) if value is True else value for key, value in told.items()})


def from_query(query: str) -> Playing:
    """The state in a link; what is no parameter, or not possible, is left as at first."""
    kinds = {name: type(value) for name, value in asdict(Playing()).items()}
    found: dict[str, Any] = {}
    for key, text in parse_qsl(query.lstrip("?")):
        try:
            value = float(text)
        except ValueError:
            continue
        if key in kinds and math.isfinite(value):
            found[key] = kinds[key](value)
    state = Playing(**found)
    try:
        _ = state.joint
    except ValueError:
        return Playing()
    return state


def as_configuration(state: Playing) -> str:
    """A study of the joint, as YAML."""
    hold = f"{{pressure: {1e3 * state.pressure:g}}}" if state.pressure else "plate"
    lines = [
        "samples:",
        f"  mine: {{locks: {state.locks}}}",
        f"geometry: {{a: {state.a / 1e3:g}, b: {state.b / 1e3:g}, h: {state.h / 1e3:g}, "
        f"H: {state.H / 1e3:g}}}",
        "materials:",
        *([f"  young: {1e9 * state.young:g}"] if state.young else []),
        f"  inner: {{cohesion: {1e3 * state.cohesion:g}, "
        f"tensile_strength: {state.joint.inner.tensile_strength:g}}}",
        f"  dry: {{friction: {state.friction:g}}}",
        f"assembly: {{upper_body: {state.joint.upper_body}, hold_down: {hold}"
        f"{', pieces: elastic' if state.young else ''}}}",
        "meshes: [0.02]",
        f"eccentricities: [0, {state.eccentricity:g}, torsion]"
        if state.eccentricity
        else "eccentricities: [0, torsion]",
        "models: [static, law, safe]",
        "dem: {engines: []}",
        "sidmacib: {reductions: [none, lower_sum]}",
    ]
    return "\n".join(lines) + "\n"


def as_python(state: Playing) -> str:
    """The joint as Python."""
    joint = state.joint
    given = [
        f"{state.locks}",
        *(f"{name}={getattr(joint, name):g}" for name in ("a", "b", "h", "H")),
        "inner=inner",
        "dry=dry",
    ]
    if state.young:
        given.append(f"elastic=sidmacib.Elastic({joint.elastic.young:g})" if joint.elastic else "")
    if state.one_piece:
        given.append("upper_body=UpperBody.MONOLITHIC")
    if state.pressure:
        given.append(f"hold_down=sidmacib.HoldDown.pressure({1e3 * state.pressure:g})")
    return "\n".join(
        [
            "from dataclasses import replace",
            "import sidmacib",
            *(["from sidmacib.joint import UpperBody"] if state.one_piece else []),
            "",
            f"inner = replace(sidmacib.Joint(3).inner, cohesion={joint.inner.cohesion:g}, "
            f"tensile_strength={joint.inner.tensile_strength:g})",
            f"dry = replace(sidmacib.Joint(3).dry, friction={state.friction:g})",
            f"joint = sidmacib.Joint({', '.join(given)})",
            f"direction = sidmacib.Direction({state.eccentricity:g})",
            "print(sidmacib.law(joint, direction), sidmacib.safe(joint, direction))",
        ]
    )
