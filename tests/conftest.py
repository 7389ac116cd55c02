"""What all tests share: one graphics device per process, golden pictures, few software-renderer threads."""

from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from fallstreak.gpu import Device

# lavapipe starts one thread per core for every device; with one test process per core that would be cores².
# It reads the variable when the device is made, and subprocesses started by tests inherit it.
_workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
os.environ.setdefault("LP_NUM_THREADS", str(max(1, (os.cpu_count() or 1) // _workers)))

OUTPUT = Path(__file__).parent / "failed"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden", action="store_true", help="rewrite the golden pictures instead of comparing"
    )


@pytest.fixture(scope="session")
def device() -> Iterator[Device]:
    """The graphics device, opened once per test process. Without an adapter tests fail, saying what to do."""
    from fallstreak.gpu import Device, NoAdapterError

    try:
        device = Device.open()
    except NoAdapterError as error:
        pytest.fail(str(error), pytrace=False)
    yield device


@pytest.fixture(scope="module", autouse=True)
def _memory_back() -> Iterator[None]:
    """Graphs are cycles that hold textures: without this a test process grows by gigabytes."""
    yield
    gc.collect()


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[..., None]:
    """``golden("name", picture, atol=3, fraction=0.002)`` compares with tests/golden/name.png."""
    from golden import compare

    update = request.config.getoption("--update-golden")
    return lambda name, picture, **tolerances: compare(
        name, picture, update=update, output=OUTPUT, **tolerances
    )
