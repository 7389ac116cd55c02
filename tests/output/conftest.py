import pytest

from .frames import make_frame


@pytest.fixture
def frame():
    return make_frame()
