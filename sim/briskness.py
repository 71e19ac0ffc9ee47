"""How briskly the joints of a body are moved, by the part that they are of: rules, not gains.

The gains follow from them and the inertia that each joint moves.
"""

# Natural frequency [Hz] of each joint's servo, carrying the inertia that it moves, and the
# damping ratio of all: how briskly a person holds a posture.
FREQUENCY = {"waist": 3.0, "neck": 3.5, "shoulder": 3.0, "elbow": 4.0, "wrist": 6.0}
DAMPING_RATIO = 0.8
# Largest speed of each joint [deg/s], which the safety filter keeps. Chosen here, from no source.
SPEED = {"waist": 250.0, "neck": 500.0, "shoulder": 800.0, "elbow": 900.0, "wrist": 1200.0}
