"""Simplex noise is being built: until it is registered its tests are left out."""

import pytest

from fallstreak.noise.kernels import MODULES


def pytest_collection_modifyitems(items):
    if "simplex" not in MODULES:
        for item in items:
            if "simplex" in item.name:
                item.add_marker(pytest.mark.skip("simplex noise is not there yet"))
