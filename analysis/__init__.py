"""The analysis: from the cases' records to what people read.

In the order of the data: ``tables``, then ``figures``, ``summary`` and ``report``; files by ``vtk``
for ParaView. ``calibration`` runs studies of its own, ``explore`` serves pages with sliders.
``paths`` solves the static model again where pictures show nodes; ``published`` has the paper's
numbers; ``drawing`` is shared by figures, report and explorer.
"""
