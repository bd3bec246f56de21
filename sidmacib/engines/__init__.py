"""The programs that a study can run: distinct elements, and finite ones for elastic pieces.

To add one, see docs/howto/model.md.
"""

from sidmacib.engines.calculix.engine import CALCULIX
from sidmacib.engines.engine import Engine
from sidmacib.engines.liggghts.engine import LIGGGHTS
from sidmacib.engines.yade.engine import YADE

ENGINES: dict[str, Engine] = {engine.name: engine for engine in (YADE, LIGGGHTS, CALCULIX)}
