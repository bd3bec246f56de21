"""The published joints on three layouts of the contact nodes."""
