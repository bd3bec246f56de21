"""What `make docs` makes from the code: pages, pictures and equations of the site."""
