"""Runs inside a web worker, on Pyodide: one process of the page. Nothing of it is imported anywhere else."""
