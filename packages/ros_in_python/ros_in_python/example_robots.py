"""Where the robots and launch files that come with this package are."""

from pathlib import Path

from interface_compiler import prefixes

#: An ament prefix with the package humanoid_description, a robot to try things with, and turtlesim's launch files: of
#: turtlesim itself, only the messages are compiled.
EXAMPLES = Path(__file__).with_name("robot") / "prefix"


def share_folders(package: str) -> list[Path]:
    """Return where an installed package's files are, such as its launch files; an empty list if it is not installed."""
    prefix = prefixes.prefix_of(package, prefixes.installed())
    return [root / "share" / package for root in dict.fromkeys((prefix, EXAMPLES))] if prefix else []
