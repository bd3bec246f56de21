"""The steps that find a case's result; each module's ``run`` is one."""
