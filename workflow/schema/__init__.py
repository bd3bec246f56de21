"""The configuration's schema, one module per section: keys, units, ranges and defaults.

It knows no model by name: what the models can do is checked in `workflow.consistency`.
"""

from workflow.schema.study import Study

__all__ = ["Study"]
