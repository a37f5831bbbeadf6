"""``python -m petalfoil``: the command line."""

from petalfoil.cli import main

if __name__ == "__main__":
    main()
