"""What can go wrong on this floor.

OutputError   results that cannot be written where the user asked for them
InputError    a file of the user's that is not what was expected
"""


class OutputError(Exception):
    """A file or folder that cannot be written; the message says which and why."""


class InputError(Exception):
    """A file that cannot be read; the message says which, where in it, and what was expected."""
