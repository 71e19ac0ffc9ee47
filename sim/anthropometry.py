"""Body segment parameters of the adults that Adonis is modelled on.

Masses, lengths, centres of mass and principal moments are the mean subjects of
de Leva (1996), "Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters",
J. Biomechanics 29(9), 1223-1230. Shoulder breadth follows Drillis & Contini (1966):
biacromial breadth = 0.259 stature.
"""

from dataclasses import dataclass, fields, replace
from math import pi, sqrt
from typing import Self

from sim.laws import Law

TISSUE_DENSITY = 1080.0  # [kg/m^3] limbs, mean of Drillis & Contini
PALM = 0.45  # where the middle of the palm is, as a share of the hand
SEGMENTS = ("head", "whole_trunk", "upper_arm", "forearm", "hand")


@dataclass(frozen=True)
class Segment:
    """One rigid segment.

    The moments are about the segment's centre of mass, around the sagittal
    (antero-posterior), transverse (medio-lateral) and longitudinal axes.
    """

    mass: float  # [kg]
    length: float  # [m]
    com: float  # [m] from the proximal end (head: from the vertex; trunk: from C7)
    inertia: tuple[float, float, float]  # [kg m^2] sagittal, transverse, longitudinal

    @property
    def radius(self) -> float:
        """Radius of the cylinder of this mass, length and tissue density [m]."""
        return sqrt(self.mass / (TISSUE_DENSITY * pi * self.length))

    def scaled(self, law: Law) -> Self:
        """A segment that is so much longer, heavier and harder to turn."""
        sagittal, transverse, longitudinal = self.inertia
        inertia = sagittal * law.inertia, transverse * law.inertia, longitudinal * law.inertia
        return type(self)(
            self.mass * law.mass, self.length * law.length, self.com * law.length, inertia
        )

    def towards(self, other: Self, share: float) -> Self:
        """A segment between this one (share 0) and another (1), in a straight line."""

        def between(one: float, two: float) -> float:
            return (1.0 - share) * one + share * two

        (a, b, c), (d, e, f) = self.inertia, other.inertia
        return type(self)(
            between(self.mass, other.mass),
            between(self.length, other.length),
            between(self.com, other.com),
            (between(a, d), between(b, e), between(c, f)),
        )


@dataclass(frozen=True)
class Anthropometry:
    """The segments of one person, and where the trunk divides at the waist."""

    stature: float  # [m]
    mass: float  # [kg]
    head: Segment  # vertex to C7
    whole_trunk: Segment  # C7 to mid-hip
    upper_arm: Segment  # shoulder to elbow
    forearm: Segment  # elbow to wrist
    hand: Segment  # wrist to tip of the third finger
    waist_length: float  # [m] C7 to omphalion
    waist_mass: float  # [kg] what lies above the omphalion: upper and middle trunk

    @property
    def arm(self) -> float:
        """From the shoulder to the middle of the palm of an arm held straight [m]."""
        return self.upper_arm.length + self.forearm.length + PALM * self.hand.length

    def scaled(self, law: Law) -> Self:
        """A person who is so much taller and heavier, with the same proportions."""
        lengths = {name: getattr(self, name) * law.length for name in ("stature", "waist_length")}
        masses = {name: getattr(self, name) * law.mass for name in ("mass", "waist_mass")}
        segments = {name: getattr(self, name).scaled(law) for name in SEGMENTS}
        return replace(self, **lengths, **masses, **segments)

    def towards(self, other: Self, share: float) -> Self:
        """A person between this one (share 0) and another (1), in a straight line."""
        numbers = {
            field.name: (1.0 - share) * getattr(self, field.name)
            + share * getattr(other, field.name)
            for field in fields(self)
            if field.name not in SEGMENTS
        }
        segments = {
            name: getattr(self, name).towards(getattr(other, name), share) for name in SEGMENTS
        }
        return replace(self, **numbers, **segments)

    @property
    def trunk_half_axes(self) -> tuple[float, float]:
        """Half breadth and half depth [m] of the elliptic cylinder with the trunk's inertia.

        For a homogeneous elliptic cylinder I_long = m (a^2 + b^2) / 4 and
        I_sag - I_trans = m (a^2 - b^2) / 4.
        """
        sagittal, transverse, longitudinal = self.whole_trunk.inertia
        total = 4.0 * longitudinal / self.whole_trunk.mass
        difference = 4.0 * (sagittal - transverse) / self.whole_trunk.mass
        return sqrt((total + difference) / 2.0), sqrt((total - difference) / 2.0)

    @property
    def moving_trunk(self) -> Segment:
        """Upper and middle trunk (C7 to omphalion), the part above the waist joint.

        de Leva gives its mass and length; its moments are those of the elliptic
        cylinder of `trunk_half_axes`, cut at the omphalion.
        """
        a, b = self.trunk_half_axes
        m, length = self.waist_mass, self.waist_length
        across = length**2 / 12.0
        inertia = (
            m * (across + a**2 / 4.0),
            m * (across + b**2 / 4.0),
            m * (a**2 + b**2) / 4.0,
        )
        return Segment(m, length, length / 2.0, inertia)


MALE = Anthropometry(
    stature=1.741,
    mass=73.0,
    head=Segment(5.066, 0.2429, 0.1215, (0.02744, 0.02966, 0.02036)),
    whole_trunk=Segment(31.726, 0.6033, 0.3100, (1.2423, 1.0812, 0.3298)),
    upper_arm=Segment(1.978, 0.2817, 0.1626, (0.01275, 0.01136, 0.00392)),
    forearm=Segment(1.183, 0.2689, 0.1230, (0.00651, 0.00600, 0.00125)),
    hand=Segment(0.445, 0.1879, 0.0681, (0.00130, 0.00087, 0.00053)),
    waist_length=0.4576,
    waist_mass=11.651 + 11.921,
)

FEMALE = Anthropometry(
    stature=1.735,
    mass=61.9,
    head=Segment(4.135, 0.2437, 0.1180, (0.01804, 0.02137, 0.01673)),
    whole_trunk=Segment(26.351, 0.6148, 0.3052, (0.93873, 0.84923, 0.21523)),
    upper_arm=Segment(1.578, 0.2751, 0.1583, (0.00923, 0.00808, 0.00262)),
    forearm=Segment(0.854, 0.2643, 0.1205, (0.00406, 0.00394, 0.00053)),
    hand=Segment(0.347, 0.1701, 0.0583, (0.00060, 0.00043, 0.00024)),
    # Upper 15.45 % and middle 14.65 % of body mass; omphalion 0.1815 m above mid-hip.
    waist_length=0.6148 - 0.1815,
    waist_mass=0.3010 * 61.9,
)
