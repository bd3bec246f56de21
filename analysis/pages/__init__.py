"""Numbers in pages: made from tables of a study, between marks, none typed by hand."""
