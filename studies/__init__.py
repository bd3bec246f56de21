"""Campaigns: each with its configuration, its jobs and figures, and the numbers of its page."""
