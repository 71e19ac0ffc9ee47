"""`python -m adonis.lint_study [TASKS] [SEED]`: see the package."""

import sys

from adonis.lint_study.studying import study, table

if __name__ == "__main__":
    found = study(*[int(word) for word in sys.argv[1:3]] or (200,))
    print(table(found))
    for case in found:
        if case.said != case.true or not all(case.advice):
            print(f"  {case.kind} {case.seed}: said {case.said}, true {case.true} {case.advice}")
