"""What tells students how to begin, and their computers what to install."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import metadata

from jinja2 import Environment, PackageLoader, StrictUndefined

from spinbook import __version__
from spinbook.handout.interface_wheels import requirement

#: What must be the same for students as for the instructor who made the handout, so that checks come out the same.
_PINNED = ("ros-{distro}-rclpy", "ros-{distro}-rmw-fastrtps-cpp", "ros-{distro}-common-interfaces")

#: Name in the handout -> template.
_TEMPLATES = {
    "README.md": "README.md.j2",
    "requirements.txt": "requirements.txt.j2",
    "environment.yml": "environment.yml.j2",
    ".devcontainer/devcontainer.json": "devcontainer.json.j2",
}


@dataclass(frozen=True)
class Listing:
    """An exercise as the README lists it: how many checks students may run, and how many come later."""

    name: str
    title: str
    file: str
    public: int
    hidden: int


def guide_files(
    title: str,
    slug: str,
    distro: str,
    wheel: str,
    notebooks: list[str],
    exercises: list[Listing],
    interfaces: list[str],
) -> dict[str, bytes]:
    """README.md and the files that install, by name. `interfaces` are the names of wheels with compiled interfaces."""
    # Plain text and JSON, no HTML.
    environment = Environment(
        loader=PackageLoader("spinbook.handout", "template"),
        autoescape=False,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    values = {
        "title": title,
        "slug": slug,
        "distro": distro,
        "wheel": wheel,
        "notebooks": notebooks,
        "exercises": exercises,
        "pins": _pins(distro),
        "interfaces": [requirement(file) for file in interfaces],
        "pythons": sorted({file.split("-")[2].replace("cp3", "3.") for file in interfaces}),
        "version": __version__,
    }
    return {name: environment.get_template(template).render(values).encode() for name, template in _TEMPLATES.items()}


def _pins(distro: str) -> list[str]:
    """The versions of ROS 2's wheels that are installed here; none where ROS 2 is a sourced one."""
    found = []
    for name in (pattern.format(distro=distro) for pattern in _PINNED):
        try:
            found.append(f"{name}=={metadata.version(name)}")
        except metadata.PackageNotFoundError:
            continue
    return found
