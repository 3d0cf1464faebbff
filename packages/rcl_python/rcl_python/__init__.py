"""rcl in pure Python: replaces rclpy's compiled module `_rclpy_pybind11`, so that rclpy's own files run anywhere.

rclpy's `.py` files and the generated message classes are Python already. Two things below them are compiled: the
module `rclpy._rclpy_pybind11` (rcl, rmw and DDS underneath) and the converters of messages. This package replaces both
without a thread, a socket or a compiler, so nodes run in a web page (Pyodide) as they do under CPython:

    import rcl_python
    rcl_python.install()        # before rclpy is imported
    import rclpy

Nodes of one process reach each other at once. Nodes of other processes are reached through a `Link` (link.py).
"""

from rcl_python.install import install

__all__ = ["install"]
