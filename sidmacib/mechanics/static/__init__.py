"""The static model: the load rises until bonds fail, and on to the peak."""
