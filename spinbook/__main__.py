"""`python -m spinbook`."""

from spinbook.cli import main

main()
