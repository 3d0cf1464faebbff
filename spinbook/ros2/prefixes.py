"""Where ROS packages are installed: what the interface compiler knows of it, under the name that is used here."""

from interface_compiler.prefixes import RESOURCES, installed, packages, prefix_of, resources

__all__ = ["RESOURCES", "installed", "packages", "prefix_of", "resources"]
