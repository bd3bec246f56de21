"""The programs that a study can run: distinct elements, and finite ones for elastic pieces.

To add one, see CONTRIBUTING.md.
"""

from workflow.engines.calculix.engine import CALCULIX
from workflow.engines.engine import Engine
from workflow.engines.liggghts.engine import LIGGGHTS
from workflow.engines.yade.engine import YADE

ENGINES: dict[str, Engine] = {engine.name: engine for engine in (YADE, LIGGGHTS, CALCULIX)}
