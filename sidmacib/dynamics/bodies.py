"""Rigid bodies that move: compiled."""

# mypy: allow-untyped-defs

from collections import namedtuple

import numpy as np

from sidmacib.mechanics.compilation import compiled

# `mass` (kg; 0: cannot move), `inertia` and its `inverse` about the centroid as built.
Bodies = namedtuple("Bodies", "mass inertia inverse")
# `centre` (m), `turn`: quaternion, `speed` (m/s), `spin` (rad/s).
State = namedtuple("State", "centre turn speed spin")
# Where bodies are: matrices of `turn`s, `inertia` and its `inverse`.
Frames = namedtuple("Frames", "turn inertia inverse")


@compiled
def advance(bodies, state, h):
    """Move all free bodies for a time of ``h`` (s)."""
    for p in range(len(bodies.mass)):
        if bodies.mass[p] == 0.0:
            continue
        angle = 0.0
        for i in range(3):
            state.centre[p, i] += h * state.speed[p, i]
            angle += state.spin[p, i] ** 2
        angle = np.sqrt(angle) * h
        if angle == 0.0:
            continue
        share = np.sin(0.5 * angle) / angle * h
        a = np.cos(0.5 * angle)
        x, y, z = share * state.spin[p, 0], share * state.spin[p, 1], share * state.spin[p, 2]
        q = state.turn[p]
        w, i, j, k = q[0], q[1], q[2], q[3]
        q[0] = a * w - x * i - y * j - z * k
        q[1] = a * i + x * w + y * k - z * j
        q[2] = a * j - x * k + y * w + z * i
        q[3] = a * k + x * j - y * i + z * w
        length = np.sqrt(q[0] ** 2 + q[1] ** 2 + q[2] ** 2 + q[3] ** 2)
        for n in range(4):
            q[n] /= length


@compiled
def _turned(matrix, R, out):
    """``out`` = R ``matrix`` R^T."""
    half = np.zeros((3, 3))
    for i in range(3):
        for j in range(3):
            for k in range(3):
                half[i, j] += R[i, k] * matrix[k, j]
    for i in range(3):
        for j in range(3):
            out[i, j] = 0.0
            for k in range(3):
                out[i, j] += half[i, k] * R[j, k]


@compiled
def put_frames(bodies, state, frames):
    """Fill the ``frames`` where bodies are."""
    for p in range(len(bodies.mass)):
        w, x, y, z = state.turn[p]
        R = frames.turn[p]
        R[0, 0], R[0, 1] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z)
        R[0, 2], R[1, 0] = 2 * (x * z + w * y), 2 * (x * y + w * z)
        R[1, 1], R[1, 2] = 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
        R[2, 0], R[2, 1] = 2 * (x * z - w * y), 2 * (y * z + w * x)
        R[2, 2] = 1 - 2 * (x * x + y * y)
        if bodies.mass[p] > 0.0:
            _turned(bodies.inertia[p], R, frames.inertia[p])
            _turned(bodies.inverse[p], R, frames.inverse[p])


@compiled
def accelerate(bodies, state, frames, forces, levers, ground, h):
    """Add to velocities what ``forces`` and the ``ground`` do in a time of ``h`` (s).

    ``forces``: (P, 3), N; ``levers``: arms from centroids times forces, as built, (P, 3, 3), N m;
    ``ground``: its acceleration, m/s2, (3,).
    """
    for p in range(len(bodies.mass)):
        if bodies.mass[p] == 0.0:
            continue
        w, R = state.spin[p], frames.turn[p]
        L, B = np.zeros(3), np.zeros((3, 3))
        for i in range(3):
            for j in range(3):
                L[i] += frames.inertia[p, i, j] * w[j]
                for k in range(3):
                    B[i, j] += R[i, k] * levers[p, k, j]
        torque = (
            B[1, 2] - B[2, 1] - (w[1] * L[2] - w[2] * L[1]),
            B[2, 0] - B[0, 2] - (w[2] * L[0] - w[0] * L[2]),
            B[0, 1] - B[1, 0] - (w[0] * L[1] - w[1] * L[0]),
        )
        for i in range(3):
            state.speed[p, i] += h * (forces[p, i] / bodies.mass[p] - ground[i])
        for i in range(3):
            for j in range(3):
                w[i] += h * frames.inverse[p, i, j] * torque[j]
