"""Pages and equations of the site that `make docs` builds."""
