"""LZW as in TIFF 6.0, section 13, compiled: many surveys publish their elevations so."""

from __future__ import annotations

import numpy as np
from numba import njit

from ...noise.machine_code import keyed

_CLEAR, _END, _FIRST, _MOST = 256, 257, 258, 4096


@keyed
@njit(cache=True, nogil=True)
def unpack(data, out):
    """Unpack bytes into ``out`` until either ends.

    Every string of the table has been written out once before, followed by the byte that the next entry adds
    to it: a place in the output and a length are all that an entry needs.

    Parameters
    ----------
    data, out : uint8 arrays

    Returns
    -------
    int : bytes written, or −1 for a code that no table holds
    """
    place, length = np.zeros(_MOST + 1, np.int64), np.zeros(_MOST + 1, np.int64)
    entries, width = _FIRST, 9
    bits, held, at, written = 0, 0, 0, 0
    before, before_length = 0, 0
    while written < len(out):
        while held < width:
            if at >= len(data):
                return written
            bits = ((bits << 8) | data[at]) & 0xFFFFFFFF
            held += 8
            at += 1
        held -= width
        code = (bits >> held) & ((1 << width) - 1)
        if code == _END:
            return written
        if code == _CLEAR:
            entries, width, before_length = _FIRST, 9, 0
            continue
        if before_length > 0 and entries < _MOST:
            place[entries], length[entries] = before, before_length + 1
            entries += 1
        if code >= entries or (before_length == 0 and code > 255):
            return -1
        before = written
        if code < 256:
            out[written] = code
            before_length = 1
        else:
            before_length = length[code]
            for k in range(min(before_length, len(out) - written)):
                out[written + k] = out[place[code] + k]
        written = min(written + before_length, len(out))
        # the width grows one code early
        if width < 12 and entries + 1 >= 1 << width:
            width += 1
    return written
