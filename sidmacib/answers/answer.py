"""What a model answers, for a joint or a structure, in one form for all doors."""

from dataclasses import dataclass

from sidmacib.errors import reason
from sidmacib.problem import Counts, Failures

LIMIT, NO_DILATION, STATIC = "limit", "limit, no dilation", "static"


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The load (N) that a ``model`` finds, or the angle (degrees) where gravity turns: ``value``.

    None where it has none, because of an ``error``. ``failures``: first failure and peak;
    ``counts``, ``mode``: of the static model of structures; ``mesh_error``: of the value, over it;
    ``spread``: of a joint's peaks, see `sidmacib.mechanics.static.peaks`. ``bounds``: whether
    nothing carries more, of limit analysis. ``notes``: what it rests on, and how blocks move.
    """

    model: str
    value: float | None = None
    failures: Failures | None = None
    counts: Counts | None = None
    mesh_error: float | None = None
    spread: float | None = None
    mode: str | None = None
    bounds: bool = True
    notes: tuple[str, ...] = ()
    error: Exception | None = None

    @property
    def note(self) -> str:
        """The notes in a line, or why there is no answer."""
        return "; ".join(self.notes) if self.error is None else reason(self.error)
