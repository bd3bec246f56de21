"""Contacts of all solids where bodies are, which know their impulses of the step before."""

# mypy: allow-untyped-defs

from collections import namedtuple

import numpy as np

from sidmacib.dynamics.collide import POINTS, meet
from sidmacib.mechanics.compilation import compiled

# Convex solids of pieces, as built. `piece`: of each; numbers at which those of each begin:
# `vertices`, `sides`, `edges` (directions) and `rims` (edges, by `ends`); `outlines`: of each side
# in `corners`, which are numbers of vertices. `size` of each, m.
Solids = namedtuple("Solids", "piece vertices sides outlines corners edges rims ends size")
# Of solids: `vertices` (m), `normals` of sides and `edges`' directions, about centroids or placed.
Places = namedtuple("Places", "vertices normals edges")
# `solids`: numbers of both, (K, 2); `friction` of each; `side`: on which they last met, or -1.
Pairs = namedtuple("Pairs", "solids friction side")
# `count`: (1,); `pair`; pieces `one` and `other`; `frame`: normal from one to other, tangents;
# `place` (m), `gap` (m), `impulse` (N s) along the frame, on the other.
Contacts = namedtuple("Contacts", "count pair one other frame place gap impulse mu")

SAME = 0.02  # over a solid's size: contacts of two steps that are the same


@compiled
def _rotated(R, vector, out):
    for i in range(3):
        out[i] = R[i, 0] * vector[0] + R[i, 1] * vector[1] + R[i, 2] * vector[2]


@compiled
def put_solids(solids, built, centre, turn, now):
    """Fill the places ``now`` of solids, whose pieces have moved from where they were ``built``."""
    for s in range(len(solids.piece)):
        p = solids.piece[s]
        for k in range(solids.vertices[s], solids.vertices[s + 1]):
            _rotated(turn[p], built.vertices[k], now.vertices[k])
            for i in range(3):
                now.vertices[k, i] += centre[p, i]
        for k in range(solids.sides[s], solids.sides[s + 1]):
            _rotated(turn[p], built.normals[k], now.normals[k])
        for k in range(solids.edges[s], solids.edges[s + 1]):
            _rotated(turn[p], built.edges[k], now.edges[k])


@compiled
def _put_frame(normal, frame):
    """Fill a ``frame`` with a ``normal`` and two tangents."""
    along_x = abs(normal[0]) >= 0.6
    t = (-normal[2], 0.0, normal[0]) if along_x else (0.0, normal[2], -normal[1])
    length = np.sqrt(t[0] ** 2 + t[1] ** 2 + t[2] ** 2)
    for i in range(3):
        frame[0, i], frame[1, i] = normal[i], t[i] / length
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        frame[2, i] = frame[0, j] * frame[1, k] - frame[0, k] * frame[1, j]


@compiled
def _remember(before, first, pair, now, c, near):
    """Give the contact ``c`` the impulse of the nearest one ``before`` of the same ``pair``."""
    best, nearest = near * near, -1
    while first < before.count[0] and before.pair[first] == pair:
        apart = 0.0
        for i in range(3):
            apart += (before.place[first, i] - now.place[c, i]) ** 2
        if apart < best:
            best, nearest = apart, first
        first += 1
    for i in range(3):
        now.impulse[c, i] = 0.0
        if nearest >= 0:
            for j in range(3):
                along = 0.0
                for k in range(3):
                    along += before.frame[nearest, k, j] * before.impulse[nearest, k]
                now.impulse[c, i] += now.frame[c, i, j] * along


@compiled
def find_contacts(solids, places, pairs, reach, before, now):
    """Fill the contacts ``now`` of all ``pairs`` no further apart than ``reach`` (m)."""
    normal, place, gaps = np.empty(3), np.empty((POINTS, 3)), np.empty(POINTS)
    count, old = 0, 0
    for k in range(len(pairs.solids)):
        one, other = pairs.solids[k]
        size = min(solids.size[one], solids.size[other])
        found, side = meet(
            solids, places, one, other, size, reach, pairs.side[k], normal, place, gaps
        )
        pairs.side[k] = side
        while old < before.count[0] and before.pair[old] < k:
            old += 1
        for c in range(found):
            _put_frame(normal, now.frame[count])
            for i in range(3):
                now.place[count, i] = place[c, i]
            now.gap[count] = gaps[c]
            now.pair[count], now.mu[count] = k, pairs.friction[k]
            now.one[count], now.other[count] = solids.piece[one], solids.piece[other]
            _remember(before, old, k, now, count, SAME * size)
            count += 1
    now.count[0] = count
