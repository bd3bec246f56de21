"""Shared by figures, report and explorer: names, colours, the boxes of a joint, the V-M chart."""
