"""From the cases' records to weights, fits, tables, figures and the summary."""
