"""The ranges that law and safe rule were tested in, slider by slider."""

from dataclasses import replace

import numpy as np

from analysis.explore.state import SLIDERS, Settings
from sidmacib.rule.law import require_covered

MOST_VALUES = 41  # of a slider, that are tried


def covered(state: Settings) -> dict[str, tuple[float, float] | None]:
    """The least and the largest value of each slider at which law and safe rule take the joint.

    The other sliders stay as they are. None where no value does; choices are left out.
    """
    found: dict[str, tuple[float, float] | None] = {}
    for name, slider in SLIDERS.items():
        if slider.choices:
            continue
        steps = round((slider.most - slider.least) / slider.step)
        places = np.unique(np.linspace(0, steps, min(MOST_VALUES, steps + 1)).round())
        values = [round(slider.least + float(place) * slider.step, 9) for place in places]
        inside = [value for value in values if _is_covered(state, name, value)]
        found[name] = (inside[0], inside[-1]) if inside else None
    return found


def _is_covered(state: Settings, name: str, value: float) -> bool:
    changed = replace(state, **{name: int(value) if name == "locks" else value})  # type: ignore[arg-type]
    try:
        require_covered(changed.joint)
    except ValueError:
        return False
    return True
