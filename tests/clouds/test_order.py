"""The GPU's order of things by distance: exact, and the same however they are listed."""

from __future__ import annotations

import numpy as np
import pytest

from fallstreak.clouds.order import add_order
from fallstreak.gpu import FrameGraph


def ordered(device, distances, ties, count):
    graph = FrameGraph(device)
    keys = np.stack([np.asarray(distances, np.float32).view(np.uint32), np.asarray(ties, np.uint32)], 1)
    graph.buffer_data("keys", keys)
    graph.buffer_data("count", np.array([0, 0, count, 0], np.uint32))
    name = add_order(graph, "things", keys="keys", count="count", word=2, capacity=len(keys))
    graph.output(name)
    graph.compile()
    graph.execute()
    return np.array(graph.read(name)).view(np.uint32).ravel()[:count]


@pytest.mark.parametrize("count", [0, 1, 63, 30_000])
def test_far_comes_before_near(device, count):
    rng = np.random.default_rng(count)
    distances = 10.0 ** rng.uniform(-1.0, 7.4, max(count, 1) + 5)
    ties = rng.permutation(len(distances))
    found = ordered(device, distances, ties, count)
    single = distances[:count].astype(np.float32)
    np.testing.assert_array_equal(found, np.lexsort((ties[:count], -single)))


def test_order_does_not_depend_on_the_listing(device):
    rng = np.random.default_rng(1)
    distances = np.round(rng.uniform(900.0, 1000.0, 2000))  # many are equal
    ties = rng.permutation(2000)
    shuffled = rng.permutation(2000)
    first = ordered(device, distances, ties, 2000)
    second = ordered(device, distances[shuffled], ties[shuffled], 2000)
    np.testing.assert_array_equal(ties[first], ties[shuffled][second])
