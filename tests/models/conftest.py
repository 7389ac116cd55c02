"""What the tests of models share."""

from __future__ import annotations

import pytest

from .files import Maker


@pytest.fixture
def maker() -> Maker:
    """A glTF in the making."""
    return Maker()
