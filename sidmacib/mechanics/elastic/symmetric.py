"""Symmetric positive definite matrices, by LAPACK and without copies: they are large.

LAPACK prints an error of its own about a matrix of no rows, as where no gap is open: it gets none.
"""

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotri

from sidmacib.errors import SolverError
from sidmacib.mechanics.assembly import Floats


def cholesky_factor(matrix: Floats) -> Floats:
    """Lower factor of a symmetric positive definite ``matrix``, which is overwritten."""
    if not len(matrix):
        return matrix
    # Its transpose is in LAPACK's order, so that nothing is copied.
    factor, failed = dpotrf(matrix.T, lower=1, overwrite_a=True)
    if failed:
        raise SolverError("stiffness of elastic blocks: not positive definite")
    return np.asarray(factor)


def inverse_by(factor: Floats) -> Floats:
    """Inverse of the matrix with this `cholesky_factor`, which is overwritten."""
    if not len(factor):
        return factor
    inverse, _ = dpotri(factor, lower=1, overwrite_c=True)
    for column in range(len(inverse)):
        inverse[column, column + 1 :] = inverse[column + 1 :, column]
    return np.asarray(inverse)
