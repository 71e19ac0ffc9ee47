"""`python -m adonis` is the same as `adonis`."""

from adonis.cli import main

if __name__ == "__main__":
    main()
