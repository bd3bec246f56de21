"""What acts in time: ground motions, by pulses or records, a sudden force, speeds, a lost support.

Accelerations of the ground are given to steps by their means, as differences of its velocity.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Protocol

import numpy as np

from sidmacib.mechanics.assembly import GRAVITY, Floats
from sidmacib.structure.loads import StructureLoads

IN_TIME = "load.duration: what acts in time is for multilock assembly, and earthquakes of a study"
AT2 = re.compile(r"NPTS\s*=\s*(\d+).*?DT\s*=\s*([-+.\dEe]+)", re.IGNORECASE | re.DOTALL)
OTHER = re.compile(r"VELOCITY|DISPLACEMENT|CM/S\S*", re.IGNORECASE)
AT2_HEAD = 4  # lines
UNITS = {"m/s2": 1.0, "cm/s2": 0.01, "g": GRAVITY}  # of records


class Shape(StrEnum):
    """The shape of a pulse of acceleration."""

    RECTANGLE = "rectangle"
    HALF_SINE = "half-sine"
    CYCLE = "cycle"  # of a sine


class Ground(Protocol):
    """A ground motion, which ends at a time, ``end`` (s)."""

    @property
    def end(self) -> float:
        """In s."""
        ...

    def velocity(self, time: Floats) -> Floats:
        """At times from the start (s), (K,): m/s, (K, 3)."""
        ...


@dataclass(frozen=True)
class Pulse:
    """A pulse of the ``acceleration`` (m/s2) along a unit ``direction`` for a ``duration`` (s)."""

    shape: Shape
    acceleration: float
    duration: float
    direction: tuple[float, ...]

    @property
    def end(self) -> float:
        """See `Ground`."""
        return self.duration

    def velocity(self, time: Floats) -> Floats:
        """See `Ground`."""
        part = np.clip(time, 0.0, self.duration) / self.duration
        if self.shape is Shape.HALF_SINE:
            part = (1.0 - np.cos(np.pi * part)) / np.pi
        elif self.shape is Shape.CYCLE:
            part = (1.0 - np.cos(2.0 * np.pi * part)) / (2.0 * np.pi)
        return np.outer(self.acceleration * self.duration * part, self.direction)


@dataclass(frozen=True, eq=False)
class Accelerogram:
    """Accelerations (m/s2) at times (s), both (K,), linear in between, along a unit direction."""

    time: Floats
    acceleration: Floats
    direction: tuple[float, ...]

    @classmethod
    def of(cls, rows: Floats, factor: float, direction: tuple[float, ...]) -> "Accelerogram":
        """From ``rows`` of times and of accelerations, which ``factor`` turns into m/s2.

        It begins at the first time. ValueError for times that do not grow.
        """
        if not np.isfinite(rows).all() or not (np.diff(rows[:, 0]) > 0.0).all():
            raise ValueError("times must grow, and numbers must be finite")
        return cls(rows[:, 0] - rows[0, 0], factor * rows[:, 1], direction)

    @property
    def end(self) -> float:
        """See `Ground`."""
        return float(self.time[-1])

    @property
    def values(self) -> dict[str, list[float]]:
        """Times and accelerations by name."""
        return {"time": self.time.tolist(), "acceleration": self.acceleration.tolist()}

    def velocity(self, time: Floats) -> Floats:
        """See `Ground`; beyond the record the ground moves on as it did at its end."""
        t, a = self.time, self.acceleration
        whole = np.concatenate([[0.0], np.cumsum(0.5 * (a[1:] + a[:-1]) * np.diff(t))])
        inside = np.clip(time, t[0], t[-1])
        k = np.clip(np.searchsorted(t, inside, side="right") - 1, 0, len(t) - 2)
        part = inside - t[k]
        slope = (a[k + 1] - a[k]) / (t[k + 1] - t[k])
        return np.outer(whole[k] + part * (a[k] + 0.5 * slope * part), self.direction)


def accelerogram(
    path: Path, unit: float | None, scale: float, direction: tuple[float, ...]
) -> Accelerogram:
    """The record in a file: columns of time (s) and acceleration, or PEER's AT2.

    ``unit``: of accelerations, in m/s2; None: g in AT2, else m/s2. ``scale``: their factor.
    ValueError for a file that is neither, or whose times do not grow.
    """
    text = path.read_text(encoding="utf-8", errors="replace")
    if path.suffix.lower() == ".at2":
        found = AT2.search(text)
        values = " ".join(text.splitlines()[AT2_HEAD:]).split()
        if found is None or len(values) < 2 or not all(map(_is_number, values)):
            raise ValueError(f"{path.name}: must have NPTS= and DT= in its head, and numbers")
        if other := OTHER.search("\n".join(text.splitlines()[:AT2_HEAD])):
            raise ValueError(f"{path.name}: its head says {other[0]}; it must be acceleration in g")
        if len(values) != int(found[1]):
            raise ValueError(f"{path.name}: has {len(values)} values; NPTS says {found[1]}")
        steps = float(found[2])
        rows = np.array([(k * steps, float(each)) for k, each in enumerate(values)])
        unit = GRAVITY if unit is None else unit
    else:
        split = [(re.split(r"[\s,;]+", line.strip()), line) for line in text.splitlines()]
        numbers = [line for line, _ in split if _is_number(line[0])]
        whole = all(len(line) == 2 and _is_number(line[1]) for line in numbers)
        commas = any(";" in text and "," in text for line, text in split if _is_number(line[0]))
        if len(numbers) < 2 or not whole or commas:
            allowed = "two columns, time (s) and acceleration, with decimal points"
            raise ValueError(f"{path.name}: must have {allowed}")
        rows = np.array([(float(line[0]), float(line[1])) for line in numbers])
    try:
        return Accelerogram.of(rows, scale * (1.0 if unit is None else unit), direction)
    except ValueError as error:
        raise ValueError(f"{path.name}: {error}") from None


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


@dataclass(frozen=True, kw_only=True)
class TimeLoads(StructureLoads):
    """Permanent loads, and what acts in time from the moment 0; the variable load is 0.

    ``ground``: motions, which add up. ``sudden``: forces (N) and moments (N m) on pieces about
    their centroids, (P, 6), and ``arms`` times them as in `Permanent`, (P, 3, 3). ``speed``: of
    pieces at 0, m/s, (P, 3). ``lost``: the index of a fixed piece that is taken away. ``duration``
    and ``step``: s. ``restitution``: of the velocity with which contacts close.
    """

    ground: tuple[Ground, ...] = ()
    sudden: Floats
    arms: Floats
    speed: Floats
    lost: int | None = None
    duration: float
    step: float
    restitution: float

    @property
    def cut_off(self) -> Iterator[str]:
        """A line if the ground moves on after the end."""
        later = max((each.end for each in self.ground), default=0.0) - self.duration
        if later > self.step:
            yield f"load.duration: the ground moves on for {later:.4g} s more"

    @property
    def words(self) -> str:
        """What acts."""
        acts = [f"{len(self.ground)} motions of the ground"] if len(self.ground) > 1 else []
        acts += ["a motion of the ground"] if len(self.ground) == 1 else []
        acts += ["a sudden force"] if self.sudden.any() else []
        acts += ["a blow"] if self.speed.any() else []
        acts += ["a support is lost"] if self.lost is not None else []
        what = ", ".join(acts) or "weight alone"
        return f"In time: {what}; {self.duration:g} s in steps of {1e3 * self.step:g} ms"

    @property
    def times(self) -> Floats:
        """At which steps begin, and the end, s."""
        count = math.ceil(self.duration / self.step - 1e-9)
        return self.step * np.arange(count + 1, dtype=np.float64)

    def accelerations(self, factor: float = 1.0) -> Floats:
        """Of the ground, the mean in each step, (K, 3) in m/s2; ``factor``: on all."""
        times = self.times
        velocity: Floats = np.zeros((len(times), 3))
        for each in self.ground:
            velocity = velocity + each.velocity(times)
        change: Floats = np.diff(velocity, axis=0)
        return change * (factor / self.step)
