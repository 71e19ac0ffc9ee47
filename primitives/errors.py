"""What can go wrong on this floor.

PrimitiveError   a primitive that does not fit the body it is bound to, or an unknown one
"""


class PrimitiveError(Exception):
    """A primitive cannot be bound to this body; the message says what would fit."""
