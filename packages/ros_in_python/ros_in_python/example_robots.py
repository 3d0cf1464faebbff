"""Where the robots that come with this package are."""

from pathlib import Path

#: An ament prefix with the package humanoid_description: a robot to try things with.
EXAMPLES = Path(__file__).with_name("robot") / "prefix"
