"""Whether contact spheres still stand for flat faces.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from .assembly import Assembly, Vector, cross, dot, length, plus
from .records import NodeForce


@dataclass(frozen=True)
class Motion:
    """Displacement (m) of a piece's centroid, and its rotation as a vector (rad)."""

    displacement: Vector
    rotation: Vector


STILL = Motion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def check_flat(assembly, motions, radii, nodes, load):
    import sys
    worst=(0,0,0,0,0); eta=0.0; worst2=(0,)
    for number, face in enumerate(assembly.faces):
        n=face.normal
        turn = plus(motions[face.above].rotation, motions[face.below].rotation, -1.0)
        tilt = plus(turn, n, -dot(turn,n))
        th2 = dot(tilt,tilt)
        own=[(i,nd) for i,nd in enumerate(assembly.nodes) if nd.face==number]
        R=radii[number]
        comp=max(abs(nodes[i].normal)/(face.material.normal_stiffness*nd.area_m2) for i,nd in own)
        force=0.0
        errs=[]
        for i,nd in own:
            if not (nodes[i].bonded or nodes[i].normal>0): continue
            def move(p):
                m=motions[p]
                return plus(m.displacement, cross(m.rotation, plus(nd.position_m, assembly.pieces[p].centre_m,-1.0)))
            rel=plus(move(face.above), move(face.below), -1.0)
            slip=plus(rel,n,-dot(rel,n))
            err=-R*th2/4+dot(slip,slip)/(4*R)
            errs.append((abs(err), R*th2/4, dot(slip,slip)/(4*R)))
            force+=abs(err)*face.material.normal_stiffness*nd.area_m2
        if not errs: continue
        e=max(errs)
        xi=e[0]/comp
        eta+=force
        if xi>worst[0]: worst=(xi,face.name,th2**.5,e[1],e[2],comp)
    print("FLAT", load, "xi", worst, "eta", eta/max(load,assembly.permanent_N), flush=True)
