"""What figures, report and explorer share: names, colours, the boxes of a joint, the V-M chart."""
