"""Objects in OBJ files with their faces of any number of vertices, which may be folded.

A library that cuts faces into triangles about their first vertex cuts through the folds.
"""

from pathlib import Path

import numpy as np

from sidmacib.structure.files.repair import Face, Surface


def surfaces_in_obj(path: Path) -> dict[str, Surface]:
    """The vertices, (V, 3), and the faces of each object, by its name; that of the file without.

    ValueError for numbers that cannot be read.
    """
    places: list[list[float]] = []
    faces: dict[str, list[Face]] = {}
    name = path.name
    for line in (
        path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ").splitlines()
    ):
        key, *words = line.split() or [""]
        if key == "v":
            x, y, z = map(float, words[:3])
            places.append([x, y, z])
        elif key == "o":
            name = " ".join(words)
        elif key == "f":
            ends = [int(corner.partition("/")[0]) for corner in words]
            face = tuple(end - 1 if end > 0 else end + len(places) for end in ends)
            faces.setdefault(name, []).append(face)
    return {name: (np.array(places).reshape(-1, 3), of) for name, of in faces.items()}
