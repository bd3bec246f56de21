"""The steps that find the cases' results; each module's ``run`` does one."""
