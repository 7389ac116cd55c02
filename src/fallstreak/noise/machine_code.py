"""Where Numba keeps machine code on disk: a file per signature, so that processes never read each other's.

Numba numbers the files of a function's signatures and notes the numbers in an index. Two processes that
compile two signatures at a time take the same number, and whoever reads the index afterwards may run the
machine code of the other signature: not an error but wrong numbers. (Tests in parallel on a fresh machine
did.) Here the name of a file is a hash of what it is for, and there is no index.

Loading does without what Numba prepares for compiling: that imports half of Numba, and SciPy if it is
there, and takes longer than everything else about the first call.
"""

from __future__ import annotations

import contextlib
import functools
import glob
import hashlib
import os
import re
from typing import Any

import numba
from numba.core.caching import IndexDataCacheFile
from numba.core.runtime.nrt import rtsys

from .static import digest


class KeyedFiles(IndexDataCacheFile):
    """Data files named by their key.

    Parameters
    ----------
    base : str
        The function's part of the names.
    """

    def __init__(self, cache_path: str, base: str, source_stamp: Any):
        super().__init__(cache_path, base, source_stamp)
        self._prefix = f"{base}.{digest()[:8]}."
        # the name holds the function's line, which moves with the versions too
        versions = re.sub(r"-\d+\.", "-*.", glob.escape(base))
        self._of_function = os.path.join(glob.escape(cache_path), f"{versions}.*.nbc")

    def _name(self, key: Any) -> str:
        text = repr((numba.__version__, self._source_stamp, key))
        return f"{self._prefix}{hashlib.sha256(text.encode()).hexdigest()[:16]}.nbc"

    def load(self, key: Any) -> Any:
        """What was saved under the key, or None."""
        try:
            return self._load_data(self._name(key))
        except OSError:
            return None

    def save(self, key: Any, data: Any) -> None:
        """Save under the key; machine code of other versions of this folder goes."""
        self._save_data(self._name(key), data)
        for path in glob.glob(self._of_function):
            if not os.path.basename(path).startswith(self._prefix):
                with contextlib.suppress(OSError):
                    os.unlink(path)


def keyed(dispatcher: Any) -> Any:
    """Let a compiled function with ``cache=True`` keep its machine code so; returns it."""
    cache = getattr(dispatcher, "_cache", None)
    files = getattr(cache, "_cache_file", None)
    if cache is not None and isinstance(files, IndexDataCacheFile):
        base = files._index_name.removesuffix(".nbi")
        cache._cache_file = KeyedFiles(files._cache_path, base, files._source_stamp)
        cache.load_overload = functools.partial(_load_overload, cache)
    return dispatcher


def _load_overload(cache: Any, signature: Any, context: Any) -> Any:
    """What `cache.load_overload` does, less the preparation for compiling, for which compiling itself
    cares."""
    rtsys.initialize(context)  # the symbols that machine code refers to
    with cache._guard_against_spurious_io_errors():
        return cache._load_overload(signature, context)
