"""Verdicts of the lint against simulation, on tasks that are drawn at random.

    python -m adonis.lint_study [TASKS] [SEED]

Each task is linted first and simulated then. What is true comes from the recording:

* a goal is out of reach if the palm comes within 15 mm of it from none of eight starts in four
  seconds, by two controllers, and by way of a place outside where there is a surface;
* a time is too short if the judge fails the sub-task, or a joint passes its speed limit;
* a way collides if links touch that must not;
* a way gets stuck if the judge fails it though a second and a half is time enough;
* a range is passed if the joint runs into its end;
* a sub-task can never begin if it does not from any of eight starts, though the hand is sent to
  where its condition would hold;
* primitives fight if the joints settle elsewhere.

The constants of the lint were chosen on seeds below 10 000, and those from 10 000 to 10 199 were
looked at as well; the table is of those from 20 000 on.
"""

from adonis.lint_study.drawing import Case
from adonis.lint_study.studying import FIRST, SHARES, TRIES, study, table

__all__ = ["FIRST", "SHARES", "TRIES", "Case", "study", "table"]
