"""The workflow: from a study's configuration to the checked records of its cases.

In the order of the data: ``configuration``, ``schema`` and ``consistency`` read a study; ``cases``
and ``jobs`` divide it; ``rules`` and ``command`` have Snakemake run it; ``solve``, ``engine``,
``threedec`` and ``sampling`` find the results of a ``case``; ``results`` has records and tables.
Every script runs by ``step``, and again when its ``closure`` changes; ``site`` is documentation.
"""
