"""On GitHub, solutions stay in a repository that students can't write to, and graded programs see no secret."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml
from click.testing import CliRunner
from prepared_python import run_prepared
from tree import ROOT

from grader.classroom50.command import classroom50

TEMPLATE = ROOT / "spinbook" / "new" / "template"
EXERCISE = "speed_limit"
SOLUTION = (TEMPLATE / "solutions" / EXERCISE / "solution.py").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def grader(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that `spinbook classroom50` writes."""
    folder = tmp_path_factory.mktemp("grader") / "heartbeat"
    done = CliRunner().invoke(classroom50, [str(TEMPLATE / "exercises" / EXERCISE), "--out", str(folder)])
    assert done.exit_code == 0, done.output
    return folder


@pytest.fixture(scope="module")
def workflow(grader: Path) -> dict[Any, Any]:
    loaded: dict[Any, Any] = yaml.safe_load((grader / ".github/workflows/grade.yml").read_text(encoding="utf-8"))
    return loaded


def steps(workflow: dict[Any, Any]) -> list[dict[str, Any]]:
    """Return the steps of the only job."""
    [job] = workflow["jobs"].values()
    return list(job["steps"])


def test_nothing_that_a_student_does_starts_the_workflow_and_it_may_only_read(workflow: dict[Any, Any]) -> None:
    assert set(workflow[True]) == {"workflow_dispatch", "schedule"}  # YAML 1.1 reads the key `on` as true
    assert workflow["permissions"] == {"contents": "read"}


def test_the_token_is_only_where_no_students_program_runs(workflow: dict[Any, Any]) -> None:
    with_secrets = [step for step in steps(workflow) if "secrets." in json.dumps(step)]
    assert [step["run"].split()[:2] for step in with_secrets] == [["python3", "fetch_repositories.py"]]
    assert not any("secrets." in json.dumps(workflow[key]) for key in workflow if key != "jobs")


def test_each_step_is_a_pinned_action_or_a_command_that_a_shell_can_read(workflow: dict[Any, Any]) -> None:
    for step in steps(workflow):
        assert ("uses" in step) != ("run" in step)
        if "uses" in step:
            assert re.fullmatch(r"actions/(checkout|cache|cache/restore|cache/save|upload-artifact)@v\d+", step["uses"])
        else:
            assert subprocess.run(["bash", "-n"], input=step["run"], text=True, check=False).returncode == 0
            assert "${{" not in step["run"], "what a student could name must not become part of a command"


def test_namespaces_are_allowed_and_the_environment_is_cached(workflow: dict[Any, Any]) -> None:
    commands = [step.get("run", "") for step in steps(workflow)]
    assert any("apparmor_restrict_unprivileged_userns=0" in command for command in commands)
    assert any(command.endswith("--isolation namespaces") for command in commands)
    cached = [
        step["with"]["path"].split() for step in steps(workflow) if step.get("uses", "").startswith("actions/cache")
    ]
    assert cached == [["venv", "course/cache"], ["results"], ["results"]]


def test_every_repository_is_fetched_and_graded_as_a_class(
    grader: Path, workflow: dict[Any, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    repositories = {
        "speed-ana": {"speed_limit.py": SOLUTION},
        "speed-ben": {
            "speed_limit.py": "import os\nprint(dict(os.environ))\n",
            "json.py": "raise SystemExit('mine')\n",
        },
        "another": {},
    }
    server = tmp_path / "server" / "org"
    for name, files in repositories.items():
        make_repository(server / name, files)
    monkeypatch.setenv("PATH", f"{fake_gh(tmp_path, list(repositories))}:{os.environ['PATH']}")
    monkeypatch.setenv("GITHUB_SERVER_URL", f"file://{tmp_path / 'server'}")
    for name, value in {"OWNER": "org", "PREFIX": "speed-", "GH_TOKEN": "s3cret"}.items():
        monkeypatch.setenv(name, value)
    fetch = [sys.executable, str(grader / "fetch_repositories.py"), "submissions"]

    done = subprocess.run(fetch, cwd=grader, capture_output=True, text=True, check=False)

    assert done.returncode == 0, done.stderr
    with (grader / "submissions" / "submissions.csv").open(newline="") as file:
        assert [row["student"] for row in csv.DictReader(file)] == ["ana", "ben"]
    assert "s3cret" not in "".join(file.read_text() for file in (grader / "submissions").rglob("*") if file.is_file())
    [command] = [step["run"] for step in steps(workflow) if "-m grader" in step.get("run", "")]
    words = [*command.partition("-m grader ")[2].split()[:-1], "none"]
    graded = run_prepared("grader", *words, cwd=grader)
    assert graded.returncode == 0, graded.stdout + graded.stderr
    points = {
        name: json.loads((grader / "results" / "students" / name / "grade.json").read_text())["final"]
        for name in ("ana", "ben")
    }
    assert points == {"ana": 20, "ben": 0}


def test_a_repository_that_can_not_be_fetched_stops_the_run(
    grader: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", f"{fake_gh(tmp_path, ['speed-cleo'])}:{os.environ['PATH']}")
    monkeypatch.setenv("GITHUB_SERVER_URL", f"file://{tmp_path}")
    for name, value in {"OWNER": "org", "PREFIX": "speed-", "GH_TOKEN": "s3cret"}.items():
        monkeypatch.setenv(name, value)

    done = subprocess.run(
        [sys.executable, str(grader / "fetch_repositories.py"), str(tmp_path)],
        capture_output=True,
        text=True,
        check=False,
    )

    assert done.returncode == 1
    assert "Could not be fetched: speed-cleo." in done.stderr


def make_repository(folder: Path, files: dict[str, str]) -> None:
    folder.mkdir(parents=True)
    for name, text in files.items():
        (folder / name).write_text(text)
    git = ["git", "-C", str(folder), "-c", "user.name=x", "-c", "user.email=x@example.org"]
    for words in (["init", "-q"], ["add", "-A"], ["commit", "-q", "--allow-empty", "-m", "mine"]):
        subprocess.run([*git, *words], check=True)


def fake_gh(folder: Path, names: list[str]) -> Path:
    """Return a folder with a `gh` that lists these repositories."""
    listed = json.dumps([{"name": name, "pushedAt": "2026-11-20T22:41:07Z"} for name in names])
    program = folder / "programs" / "gh"
    program.parent.mkdir()
    program.write_text(f"#!/bin/sh\necho '{listed}'\n")
    program.chmod(0o755)
    return program.parent


def test_a_students_result_does_not_stay_where_the_grader_could_not_be_installed(tmp_path: Path) -> None:
    shutil.copy(ROOT / "grader" / "classroom50" / "autograder.py", tmp_path)
    (tmp_path / "setup.sh").write_text("echo no network; exit 100\n")
    repository = tmp_path / "repository"
    repository.mkdir()
    (repository / "result.json").write_text('{"score": 99}')

    done = subprocess.run(
        [sys.executable, tmp_path / "autograder.py"], cwd=repository, capture_output=True, text=True, check=False
    )

    assert (done.returncode, done.stdout, done.stderr) == (1, "", "no network\n")
    assert not list(repository.iterdir())


def test_only_a_repository_whose_program_draws_waits_for_matplotlib(tmp_path: Path) -> None:
    shutil.copy(ROOT / "grader" / "classroom50" / "autograder.py", tmp_path)
    python = "mkdir -p venv/bin; ln -sf /bin/true venv/bin/python"
    (tmp_path / "setup.sh").write_text(f'cd "$(dirname "$0")"; {python}; echo "set up $1"\n')
    repository = tmp_path / "repository"
    repository.mkdir()
    printed = []
    for program in ("import rclpy\n", "import matplotlib.pyplot as plt\n"):
        (repository / "speed_limit.py").write_text(program)
        command = [sys.executable, str(tmp_path / "autograder.py")]
        printed.append(subprocess.run(command, cwd=repository, capture_output=True, text=True, check=True).stderr)

    assert printed == ["set up without-trial\n", "set up plots\n"]
