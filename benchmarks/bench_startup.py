"""How long somebody waits: for `import fallstreak`, and for a first picture from a cold start."""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median


def run(report):
    report.add(
        "import fallstreak",
        median(_import_seconds() for _ in range(5)),
        "s",
        goal="< 0.3",
        how="median of 5 new processes, time of the import statement alone, byte code cached",
    )
    seconds = _first_picture_seconds()
    report.add(
        "first picture from a cold start",
        seconds,
        "s",
        goal="< 15",
        how="new process without the driver's shader cache: fallstreak render jacksboro --size 1280x720, "
        "from starting the process to the written PNG",
    )


def _import_seconds() -> float:
    code = "import time; start = time.perf_counter(); import fallstreak; print(time.perf_counter() - start)"
    return float(
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    )


def _first_picture_seconds() -> float:
    with tempfile.TemporaryDirectory() as folder:
        # Mesa keeps compiled shaders between processes; somebody's first picture does not have that.
        environment = os.environ | {"MESA_SHADER_CACHE_DISABLE": "true", "XDG_CACHE_HOME": folder}
        environment["NUMBA_CACHE_DIR"] = folder  # nor compiled noise, should a scene want any
        picture = Path(folder) / "first.png"
        command = [sys.executable, "-m", "fallstreak.cli", "render", "jacksboro", "-o", str(picture)]
        start = time.perf_counter()
        subprocess.run([*command, "--size", "1280x720"], check=True, env=environment, stdout=subprocess.PIPE)
        seconds = time.perf_counter() - start
        assert picture.stat().st_size > 0
        return seconds
