"""Exceptions."""

from __future__ import annotations


class InputError(ValueError):
    """Invalid input, with the field, its value and what is allowed.

    >>> import furrow
    >>> try:
    ...     furrow.Cell(r0=2.0, epsilon=1.5)
    ... except furrow.InputError as error:
    ...     print(error.field, error.value, error.allowed, sep=" | ")
    epsilon | 1.5 | above 0 and below 1
    """

    def __init__(
        self,
        message: str,
        field: str | None = None,
        value: object = None,
        allowed: str | None = None,
        source: str | None = None,
    ) -> None:
        super().__init__(message)
        #: Name of the parameter or of the field of a file; None if the whole file is invalid.
        self.field = field
        #: Its value.
        self.value = value
        #: The allowed values.
        self.allowed = allowed
        #: The file, or ``furrow`` for an argument.
        self.source = source

    def __reduce__(self) -> tuple[object, ...]:
        # The default would call the class with the message alone.
        return (type(self), (str(self), self.field, self.value, self.allowed, self.source))


class NoOutcome(RuntimeError):
    """Valid input without a result: the cell has no such shape, or neither divides nor rests. The message says what
    helps."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C stopped a run. Finished divisions are in the memo, so the same call resumes."""

    def __init__(self, solved: int = 0) -> None:
        kept = f"; {solved} finished results are kept, and the same call resumes" if solved else ""
        super().__init__(f"interrupted{kept}")
        #: Divisions, or points of a sweep, that were finished.
        self.solved = solved

    def __reduce__(self) -> tuple[object, ...]:
        return (type(self), (self.solved,))
