"""The files for GitHub, Docker, dev containers and Binder: complete, pinned, and consistent with this repository."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from spinbook.site.notebooks import BRANCH, requirement
from spinbook.site.page import Repository

ROOT = Path(__file__).parents[2]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
SCRIPTS = [ROOT / "container" / "with-ros.sh", ROOT / "container" / "start.sh", ROOT / "binder" / "postBuild"]


def workflow(name: str) -> dict[Any, Any]:
    read: dict[Any, Any] = yaml.safe_load((ROOT / ".github" / "workflows" / name).read_text())
    return read


def steps(name: str) -> list[dict[str, Any]]:
    return [step for job in workflow(name)["jobs"].values() for step in job["steps"]]


@pytest.mark.parametrize("file", WORKFLOWS, ids=lambda file: file.name)
def test_every_job_has_a_limit_and_every_action_a_version(file: Path) -> None:
    jobs = workflow(file.name)["jobs"]

    assert all("timeout-minutes" in job and "ubuntu-latest" not in job["runs-on"] for job in jobs.values())
    for step in steps(file.name):
        assert ("uses" in step) != ("run" in step)
        if "uses" in step:
            assert re.fullmatch(r"[\w-]+/[\w-]+@v\d+\.\d+\.\d+", step["uses"])


def test_the_tests_run_on_every_python_that_is_supported() -> None:
    matrix = workflow("ci.yml")["jobs"]["test"]["strategy"]["matrix"]["python"]
    ((low, high),) = re.findall(r'requires-python = ">=3\.(\d+),<3\.(\d+)"', (ROOT / "pyproject.toml").read_text())

    assert matrix == [f"3.{minor}" for minor in range(int(low), int(high))]
    assert ".ci/run" in {step.get("run") for step in steps("ci.yml")}


def test_the_site_that_the_course_makes_is_what_is_published() -> None:
    published = next(step for step in steps("pages.yml") if "upload-pages-artifact" in step.get("uses", ""))

    assert "make course" in {step.get("run") for step in steps("pages.yml")}
    assert published["with"]["path"] == "build/site"
    assert workflow("pages.yml")["jobs"]["deploy"]["permissions"] == {"pages": "write", "id-token": "write"}


def test_the_notebooks_that_the_site_leads_to_are_pushed_by_a_job_that_runs_no_course() -> None:
    job = workflow("pages.yml")["jobs"]["notebooks"]
    kept = next(step for step in steps("pages.yml") if "upload-artifact@" in step.get("uses", ""))

    assert kept["with"] == {"name": "launch", "path": "build/launch", "include-hidden-files": True}
    assert job["permissions"] == {"contents": "write"}
    assert f"git init -q -b {BRANCH}" in job["steps"][-1]["run"]
    assert "make course" not in {step.get("run") for step in job["steps"]}


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.name)
def test_a_script_is_one_and_may_be_run(script: Path) -> None:
    subprocess.run(["sh", "-n", script], check=True)
    assert script.stat().st_mode & 0o111


def test_what_the_image_copies_and_starts_is_there() -> None:
    text = (ROOT / "Dockerfile").read_text()

    for source in re.findall(r"^COPY (?:--\S+ )*(\S+) ", text, re.MULTILINE):
        assert (ROOT / source).exists()
    (start,) = re.findall(r'^CMD \["(\S+)"\]', text, re.MULTILINE)
    assert (ROOT / start).exists()
    stages = set(re.findall(r"^FROM \S+ AS base-(\w+)$", text, re.MULTILINE))
    assert stages == {"amd64", "arm64"}
    assert re.findall(r"^USER (\w+)$", text, re.MULTILINE) == ["student"]


def test_the_dev_container_is_the_image() -> None:
    content = json.loads((ROOT / ".devcontainer" / "devcontainer.json").read_text())

    assert (ROOT / ".devcontainer" / content["build"]["dockerfile"]).resolve() == ROOT / "Dockerfile"
    assert content["remoteUser"] == "student"
    assert content["workspaceFolder"] == "/course"
    assert f"{content['workspaceFolder']}\n" in (ROOT / "Dockerfile").read_text()


def test_a_courses_requirements_that_are_no_utf8_name_no_other_place_for_spinbook(tmp_path: Path) -> None:
    (tmp_path / "requirements.txt").write_bytes("numpy\n".encode("utf-16"))

    assert (
        requirement(Repository(tmp_path, ""))
        == "spinbook[ros,colcon,notebooks] @ git+https://github.com/spinbook/spinbook"
    )


def test_a_notebook_that_draws_with_matplotlib_is_opened_elsewhere_with_it(tmp_path: Path) -> None:
    cells = ["import rclpy\n", "from matplotlib import pyplot\n"]

    assert requirement(Repository(tmp_path, ""), cells).startswith("spinbook[ros,colcon,notebooks,plots] @ ")
