"""The number of locks that work: the law against the static model, on joints of all sizes."""
