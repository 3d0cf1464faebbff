"""Runs a course's nodes in the reader's browser: the files that the site needs for it, and the code inside the page.

`files.py` collects the files: Pyodide (pyodide.py), rclpy and the message classes from the installed wheels,
rcl_python, and `in_page`, which is the Python that runs in web workers. `static` is the JavaScript of the page and
its workers.
"""
