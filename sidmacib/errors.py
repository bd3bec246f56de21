"""Errors of models that find no answer."""

DOES_NOT_STAND = "The structure does not stand under its own weight"


class CapacityError(RuntimeError):
    """A model has no largest load; the message names what was asked and the reason."""


class InfeasibleError(CapacityError):
    """No forces balance the permanent loads."""


class UnboundedError(CapacityError):
    """The load can grow without limit."""


class SolverError(CapacityError):
    """No solver came to a verdict that passes its check."""


class NoEquilibriumError(CapacityError):
    """No equilibrium was found at a load."""


class NoStiffnessError(CapacityError):
    """Contact points stand for locks: only limit analysis has an answer."""


class ResultError(ValueError):
    """A result that is not accepted; the message is one line."""


def reason(error: Exception) -> str:
    """Why a model has no answer, in one line."""
    message = " ".join(str(error).split()) or type(error).__name__
    if isinstance(error, ArithmeticError):
        return f"numbers are too large or too small for the model ({message})"
    return message


def lacks(package: str, extra: str) -> ValueError:
    """That an optional ``package`` is not there, and the ``extra`` of multilock that brings it."""
    remedy = f"pip install '.[{extra}]' in the clone of multilock"
    return ValueError(f"needs the package {package}: {remedy}")
