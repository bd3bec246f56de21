"""Campaigns: each with its configuration, its jobs and figures, and the numbers of its page.

``locks``: the law against the static model, on joints of all sizes. ``attack``: an optimiser
searches for joints whose safe load comes closest to their capacity. ``published``: numbers and
pictures of the study of `config.yaml`; ``elastic``, ``layouts``, ``softening``: of blocks that
bend, other contact nodes, bonds that soften. ``measured``: loads of walls in laboratories, and what
a test of joints would have to measure. ``structures``: against published answers, hand formulas and
other programs; ``designed_vault``: the locks that a barrel vault needs.
"""
