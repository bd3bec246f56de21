"""Contact and friction at points of the chain's dry faces."""

from dataclasses import dataclass

import numpy as np

from sidmacib.mechanics.assembly import FaceMaterial, Floats

NOTHING = 1e-300  # N: what keeps a direction of no force from being one divided by zero


@dataclass(frozen=True)
class Contacts:
    """Points of G faces, P on each: they push and rub, and never pull.

    ``rows`` (G or 1, P, 3, W): how far a point closes, and its two slips, from the W unknowns of
    the bodies at a face; without friction (G or 1, P, 1, W). ``normal``,
    ``shear``: stiffness of each point, N/m, shape (P,).
    """

    rows: Floats
    normal: Floats
    shear: Floats
    friction: float

    @classmethod
    def of(cls, rows: Floats, areas: Floats, law: FaceMaterial, friction: float) -> "Contacts":
        """Points of these ``areas`` (m2), with the stiffnesses of ``law``.

        Smooth ones have no use for their slips.
        """
        normal, shear = law.normal_stiffness * areas, law.shear_stiffness * areas
        return cls(rows if friction else rows[:, :, :1], normal, shear, friction)

    @property
    def _flat(self) -> Floats:
        return self.rows.reshape(len(self.rows), -1, self.rows.shape[-1])

    def _moved(self, moved: Floats) -> Floats:
        """Closing and slips (G, P, 3 or 1) from the unknowns (G, W)."""
        found = np.matmul(self._flat, moved[:, :, None])
        return found.reshape(len(moved), *self.rows.shape[1:3])

    def limits(self, moved: Floats) -> Floats:
        """What friction may reach at each point, N, shape (G, P)."""
        closing = np.matmul(self.rows[:, :, 0], moved[:, :, None])[:, :, 0]
        return self.friction * self.normal * np.maximum(closing, 0.0)

    def forces(self, moved: Floats, limits: Floats | None) -> tuple[Floats, Floats]:
        """Forces (G, W) on the unknowns, and their derivatives (G, W, W).

        ``limits`` of friction, N; None: those of the forces themselves, whose derivatives are not
        symmetric then.
        """
        state = self._moved(moved)
        touching = state[..., 0] >= 0.0
        force = np.empty_like(state)
        force[..., 0] = self.normal * np.where(touching, state[..., 0], 0.0)
        derived = np.empty((len(state), *self.rows.shape[1:]))
        closing = self.rows[:, :, 0]
        derived[:, :, 0] = (self.normal * touching)[..., None] * closing
        if self.friction:
            trial = self.shear[:, None] * state[..., 1:]
            size = np.maximum(np.hypot(trial[..., 0], trial[..., 1]), NOTHING)
            most = self.friction * force[..., 0] if limits is None else limits
            slips = size > most
            part = np.where(slips, most / size, 1.0)
            force[..., 1:] = part[..., None] * trial
            along = np.where(slips[..., None], trial / size[..., None], 0.0)
            # A slip along the friction calls up no more of it, but for what presses more.
            slid = along[..., :1] * self.rows[:, :, 1] + along[..., 1:] * self.rows[:, :, 2]
            slid *= (part * self.shear)[..., None]
            if limits is None:
                slid -= self.friction * derived[:, :, 0]
            for place in (1, 2):
                own = (part * self.shear)[..., None] * self.rows[:, :, place]
                derived[:, :, place] = own - along[..., place - 1, None] * slid
        flat = self._flat
        pushed = np.matmul(force.reshape(len(force), 1, -1), flat)[:, 0]
        derived = derived.reshape(len(force), -1, flat.shape[-1])
        return pushed, np.matmul(flat.transpose(0, 2, 1), derived)
