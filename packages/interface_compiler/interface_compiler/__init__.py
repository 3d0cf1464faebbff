"""Compiles .msg, .srv and .action files into ROS 2 Python packages, with gcc and the generators of ROS's own wheels.

definition  what an author wrote, as data, and what is wrong in it
grammar     the lines of a definition, read one by one
checks      everything that can be wrong in definitions, found before anything is generated
prefixes    installed packages and their interfaces
toolchain   whether gcc and Python.h are there, and what to install if not
generators  runs ROS's code generators
gcc         runs gcc over what they wrote
prefix_builder  makes a prefix of packages, in a process of its own
store       compiled packages, kept until something they are made from changes
activation  lets this process and its children import compiled packages
near        what was compiled for a project before
wheel       compiled packages as a wheel
shipped     the definitions that come with this package
"""
