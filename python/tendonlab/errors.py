"""The three errors of the library: each message carries the name, the offending value and what was expected."""


class ParameterError(ValueError):
    """A name or a value given by the caller is unknown or out of its bounds."""


class DatasetError(ValueError):
    """A dataset breaks the format: names file, key or column, row where there is one, and what was expected."""


class NumericalError(ArithmeticError):
    """A computation left the finite numbers: names the quantity, when, and the likely cause."""
