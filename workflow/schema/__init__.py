"""The configuration's schema, one module per section: keys, units, ranges and defaults.

It names no model; `workflow.consistency` checks the abilities of models.
"""

from workflow.schema.study import Study

__all__ = ["Study"]
