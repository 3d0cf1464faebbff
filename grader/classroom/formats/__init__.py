"""One module per platform: how its export of a class is read, and the table of grades that it imports.

To add one, write its module and name it in `registry.py`; docs/grading-a-class.md lists them.
"""
