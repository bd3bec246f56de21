"""Modules of the engines' scripts, copied beside every script.

Plain Python 3.11 and, for YADE, modules of YADE: it runs outside this project's environment. It
knows pieces, faces and nodes of an assembly, and nothing of what was assembled.
"""
