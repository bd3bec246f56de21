"""Partial factors on what acts on a structure and on what it resists by (EN 1990, 6.3).

Permanent loads, weight among them, are multiplied by gamma_G, what is to be carried by gamma_Q; the
coefficients of friction, and all strengths, are divided by gamma_M (6.6a). Stiffnesses stay.
"""

from dataclasses import dataclass, replace
from typing import Annotated

from sidmacib.mechanics.assembly import Face, FaceMaterial
from sidmacib.mechanics.polygons import CondensedLocks
from sidmacib.problem import Problem
from sidmacib.quantities import Number
from sidmacib.structure.loads import StructureLoads
from sidmacib.validation import refused, require_kinds

RESISTS = (
    *("friction", "bond_friction", "cohesion", "tensile_strength"),
    *("fracture_energy", "compressive_strength"),
)


@dataclass(frozen=True)
class PartialFactors:
    """Factors on permanent loads, on what is to be carried, and under what resists; ValueError."""

    gamma_g: Annotated[float, Number(above=0, at_most=10)] = 1.0
    gamma_q: Annotated[float, Number(above=0, at_most=10)] = 1.0
    gamma_m: Annotated[float, Number(at_least=1, at_most=10)] = 1.0

    def __post_init__(self) -> None:
        require_kinds(self)

    @property
    def named(self) -> dict[str, float]:
        """The factors by their symbols."""
        return {f"gamma_{name[-1].upper()}": value for name, value in vars(self).items()}

    def __bool__(self) -> bool:
        return self != NO_FACTORS

    def __str__(self) -> str:
        return ", ".join(f"{name} = {value:g}" for name, value in self.named.items())

    def on(self, problem: Problem) -> Problem:
        """The ``problem`` with permanent loads and resistances that are design values.

        ValueError of gamma_M for condensed locks.
        """
        assembly, loads = problem
        assert isinstance(loads, StructureLoads), "loads of a structure"
        loads = replace(
            loads,
            permanent=self.gamma_g * loads.permanent,
            scale=self.gamma_g * loads.scale,
            beside=loads.beside.times(self.gamma_g),
        )
        faces = tuple(map(self._of_face, assembly.faces))
        return Problem(replace(assembly, faces=faces), loads)

    def _of_face(self, face: Face) -> Face:
        if isinstance(face, CondensedLocks) and self.gamma_m != 1.0:
            raise refused("gamma_M", self.gamma_m, "1 for condensed locks; weaken their strengths")
        return replace(face, material=self._of_law(face.material))

    def _of_law(self, law: FaceMaterial) -> FaceMaterial:
        given = {name: getattr(law, name, None) for name in RESISTS}
        weak = {name: value / self.gamma_m for name, value in given.items() if value is not None}
        return replace(law, **weak)


NO_FACTORS = PartialFactors()
