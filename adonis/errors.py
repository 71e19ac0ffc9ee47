"""What can go wrong on this floor.

OutputError   results that cannot be written where the user asked for them
"""


class OutputError(Exception):
    """A file or folder that cannot be written; the message says which and why."""
