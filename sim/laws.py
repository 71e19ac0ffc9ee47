"""The scaling laws of Hodgins & Pollard (1997), "Adapting simulated behaviors for new characters".

Their figure 3: lengths scale by L, and since gravity is the same for all, times by L^1/2. Under
geometric similarity masses scale by L^3 and moments of inertia by L^5; else by a factor M and a
factor I of their own, of what a joint or a hand moves, while lengths and times stay common to
the whole body ("mass scaling").
"""

from dataclasses import dataclass
from typing import Self


@dataclass(frozen=True)
class Law:
    """How much larger each quantity is on one system than on another.

    Raises:
        ValueError: a factor is not positive.
    """

    length: float  # L
    mass: float  # M
    inertia: float  # I

    def __post_init__(self) -> None:
        for name in ("length", "mass", "inertia"):
            if not 0.0 < getattr(self, name) < float("inf"):
                raise ValueError(f"a factor of {name} is positive, not {getattr(self, name):g}")

    @classmethod
    def geometric(cls, length: float) -> Self:
        """The law between scale models: M = L^3, I = L^5."""
        return cls(length, length**3, length**5)

    @property
    def time(self) -> float:
        """L^1/2."""
        return float(self.length**0.5)

    @property
    def velocity(self) -> float:
        """L^1/2."""
        return self.length / self.time

    @property
    def angular_velocity(self) -> float:
        """L^-1/2; frequencies too."""
        return 1.0 / self.time

    @property
    def jerk(self) -> float:
        """L^-1/2."""
        return self.length / self.time**3

    @property
    def force(self) -> float:
        """M (geometric: L^3)."""
        return self.mass

    @property
    def torque(self) -> float:
        """I L^-1 (L^4)."""
        return self.inertia / self.length

    @property
    def stiffness(self) -> float:
        """M L^-1 (L^2)."""
        return self.mass / self.length

    @property
    def damping(self) -> float:
        """M L^-1/2 (L^5/2)."""
        return self.mass / self.time

    @property
    def approach(self) -> float:
        """M L^-3/2 (L^3/2): of a damping per metre."""
        return self.damping / self.length

    @property
    def torsional_stiffness(self) -> float:
        """I L^-1 (L^4)."""
        return self.inertia / self.length

    @property
    def torsional_damping(self) -> float:
        """I L^-1/2 (L^9/2)."""
        return self.inertia / self.time
