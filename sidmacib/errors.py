"""What the models raise where they have no answer."""


class CapacityError(RuntimeError):
    """A model has no largest load; the message names what was asked and the reason."""


class InfeasibleError(CapacityError):
    """No forces balance the permanent loads."""


class UnboundedError(CapacityError):
    """The load can grow without limit."""


class SolverError(CapacityError):
    """The solver ended without a verdict."""


class NoEquilibriumError(CapacityError):
    """No equilibrium was found at a load."""
