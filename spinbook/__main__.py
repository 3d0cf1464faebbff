"""`python -m spinbook`."""

from spinbook.start import main

if __name__ == "__main__":
    main()
