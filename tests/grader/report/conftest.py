"""The class for the tests of pages."""

from __future__ import annotations

import pytest
from graded_class import graded_class

from grader.exercise import Exercise
from grader.grading import Grade


@pytest.fixture(scope="session")
def graded(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Grade]:
    """Real grades, by the name of the submission."""
    return graded_class(tmp_path_factory)[1]


@pytest.fixture(scope="session")
def exercise(tmp_path_factory: pytest.TempPathFactory) -> Exercise:
    """The exercise joint_velocity."""
    return graded_class(tmp_path_factory)[0]
