"""LIGGGHTS: its abilities (module engine), and the modules copied beside every script."""
