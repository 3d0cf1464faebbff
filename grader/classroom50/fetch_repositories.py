"""Fetches students' repositories from GitHub for grade.yml, as folders, with a table of whose they are and of when.

It runs in a repository of yours that students can't write to, and needs only Python, git and gh. The token in GH_TOKEN
can read the students' repositories; no program of theirs runs while it is there.

    OWNER=my-organization PREFIX=heartbeat- GH_TOKEN=... python3 fetch_repositories.py FOLDER
"""

import base64
import csv
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

#: More than an organization has.
MOST = "10000"


def main() -> int:
    """Fetch the repositories whose names begin with PREFIX; the rest of a name is the student. Return an exit code."""
    owner, prefix, folder = os.environ["OWNER"], os.environ["PREFIX"], Path(sys.argv[1])
    command = ["gh", "repo", "list", owner, "--limit", MOST, "--json", "name,pushedAt"]
    listed = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    rows, missing = [], []
    for repository in sorted(listed, key=lambda one: one["name"]):
        student = repository["name"].removeprefix(prefix)
        if student and student != repository["name"]:
            if fetch(owner, repository["name"], folder / student):
                rows.append((student, student, repository["pushedAt"]))
            else:
                missing.append(repository["name"])
    with (folder / "submissions.csv").open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([("file", "student", "submitted"), *rows])
    print(f"{len(rows)} repositories of {owner} begin with {prefix}.")
    if missing or not rows:
        print(
            f"Could not be fetched: {', '.join(missing) or 'any'}. Nothing is graded before all can be.",
            file=sys.stderr,
        )
    return 1 if missing or not rows else 0


def fetch(owner: str, name: str, folder: Path) -> bool:
    """Fetch the newest commit, without history, links and large files; return whether that worked."""
    shutil.rmtree(folder, ignore_errors=True)
    server = os.environ.get("GITHUB_SERVER_URL", "https://github.com")
    token = base64.b64encode(f"x-access-token:{os.environ['GH_TOKEN']}".encode()).decode()
    settings = {
        "http.extraheader": f"AUTHORIZATION: basic {token}",
        "core.symlinks": "false",
        "core.hooksPath": "/dev/null",
    }
    # In variables, other processes can't read them, and git writes none of them into the clone.
    pairs = [pair for number, one in enumerate(settings.items()) for pair in _pair(number, *one)]
    environment = {**os.environ, **dict(pairs), "GIT_CONFIG_COUNT": str(len(settings)), "GIT_LFS_SKIP_SMUDGE": "1"}
    command = ["git", "clone", "--quiet", "--depth", "1", "--no-tags", f"{server}/{owner}/{name}", str(folder)]
    fetched = subprocess.run(command, env={**environment, "GIT_TERMINAL_PROMPT": "0"}, check=False).returncode == 0
    shutil.rmtree(folder / ".git", ignore_errors=True)
    return fetched


def _pair(number: int, name: str, value: str) -> list[tuple[str, str]]:
    return [(f"GIT_CONFIG_KEY_{number}", name), (f"GIT_CONFIG_VALUE_{number}", value)]


if __name__ == "__main__":
    sys.exit(main())
