"""Motion of rigid blocks in time: contacts that come and go, steps of impulses."""
