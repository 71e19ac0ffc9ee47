"""What can go wrong on this floor.

ArbiterError   a state of the wrong size, a primitive whose torque is not finite, or one of the
               user's own that raised something or returned what is no torque
"""


class ArbiterError(Exception):
    """The arbiter cannot go on; the message names the primitive."""
