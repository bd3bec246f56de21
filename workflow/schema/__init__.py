"""The configuration's schema, a module for each section: keys, units, ranges and defaults.

It knows no model by name: what the models can is checked in `workflow.consistency`.
"""

from workflow.schema.study import Study

__all__ = ["Study"]
