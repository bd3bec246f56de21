"""Run times: on this machine, compared with other programs, and of large studies."""
