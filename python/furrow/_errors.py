"""What goes wrong, as exceptions."""

from __future__ import annotations


class InputError(ValueError):
    """Bad input: which field, its value, and what is allowed.

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
        #: Name of the parameter or of the field of a file; None where a file as a whole is bad.
        self.field = field
        #: Its value.
        self.value = value
        #: What is allowed in its place.
        self.allowed = allowed
        #: The file it stands in, or ``furrow`` for an argument.
        self.source = source

    def __reduce__(self) -> tuple[object, ...]:
        # The default would call the class with the message alone.
        return (type(self), (str(self), self.field, self.value, self.allowed, self.source))


class NoOutcome(RuntimeError):
    """Good input that nothing came of: a cell that has no such shape, or that neither divides nor rests. The message says
    what helps."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C stopped a run. What it had solved is in the memo, so that the same call goes on from there."""

    def __init__(self, solved: int = 0) -> None:
        kept = f"; what was solved so far ({solved}) is kept, and the same call goes on from there" if solved else ""
        super().__init__(f"interrupted{kept}")
        #: Divisions, or points of a sweep, that were solved before.
        self.solved = solved

    def __reduce__(self) -> tuple[object, ...]:
        return (type(self), (self.solved,))
