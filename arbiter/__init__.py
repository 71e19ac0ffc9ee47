"""Floor 4: activations, hand-over, combination, and the walk of the task graph."""

from arbiter.arbiter import Arbiter, Place
from arbiter.barriers import MARGIN
from arbiter.errors import ArbiterError

__all__ = ["MARGIN", "Arbiter", "ArbiterError", "Place"]
