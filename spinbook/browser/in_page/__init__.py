"""Runs inside a web worker, on Pyodide: one process of the page. None of it is imported anywhere else."""
