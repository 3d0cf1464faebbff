"""Kernels for the tests of what runs in a notebook."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from notebook_kernel import Kernel


@pytest.fixture
def new_kernel(tmp_path: Path) -> Iterator[Callable[..., Kernel]]:
    """Starts kernels, each in a folder of its own; they are shut down at the end of the test."""
    kernels: list[Kernel] = []

    def start(**environment: str) -> Kernel:
        folder = tmp_path / f"notebook{len(kernels)}"
        folder.mkdir()
        kernels.append(Kernel(folder, **environment))
        return kernels[-1]

    yield start
    for kernel in kernels:
        kernel.shut_down()


@pytest.fixture(scope="module")
def module_kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    """One kernel for a module's tests: starting one takes seconds."""
    kernel = Kernel(tmp_path_factory.mktemp("notebook"))
    yield kernel
    kernel.shut_down()


@pytest.fixture
def kernel(module_kernel: Kernel) -> Iterator[Kernel]:
    """A kernel in which no node runs; other tests may have run cells in it before."""
    yield module_kernel
    module_kernel.run("%stop --all")
