"""Runs a course's nodes in the reader's browser: collects the files that the site needs, and has the page's own code.

`files.py` collects the files: Pyodide, rclpy and the message classes from the installed wheels, rcl_python, and
`in_page`, the Python code that runs in web workers. `static` is the JavaScript of the page and its workers.
"""
