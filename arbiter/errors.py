"""What can go wrong on this floor.

ArbiterError   a state of the wrong size, or a primitive whose torque is not finite
"""


class ArbiterError(Exception):
    """The arbiter cannot go on; the message names the primitive, the joint and the time."""
