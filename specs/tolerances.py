"""What counts as done: how near a goal the judge wants a movement to end."""

TOUCH_AT_END = 0.03  # palm to landmark when the move's time is over [m]
TOUCH_BEFORE_NEXT = 0.015  # and just before the arm moves on [m]
ANGLE = 10.0  # arm, elbow and other joints of a posture [deg]
PALM_ANGLE = 15.0  # palm of a posture [deg]
PENETRATION = 0.005  # of any two geoms, at any step [m]
