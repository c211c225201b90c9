"""`python -m smash`: the same as the `smash` command."""

from smash.cli import main

if __name__ == "__main__":
    main()
