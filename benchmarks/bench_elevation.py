"""Large elevation models: how long until the ground stands, and how much memory that takes."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from pathlib import Path

import numpy as np

SIDE, TILE = 10_800, 3600
ROUNDS = 3

# A process of its own, so that peak memory is this file's: first what any world needs, then the file.
_OPEN = """
import json, sys, time
from pathlib import Path
import fallstreak as fs
from fallstreak.terrain.elevation import read_elevation
from fallstreak.terrain.model import elevation_paths, terrain_model

def peak():
    # Not getrusage's ru_maxrss alone: on Linux it begins with the peak of the process that started this one.
    try:
        line = next(x for x in Path("/proc/self/status").read_text().splitlines() if x.startswith("VmHWM"))
        return int(line.split()[1]) * 1024
    except OSError:
        import resource
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)

terrain_model(fs.load("orbit"))
file = json.loads(sys.argv[1])
place = {"latitude": 46.5, "longitude": 8.5}
world = fs.World(terrain={"source": "file", "file": file}, place=place)
before, start = peak(), (time.perf_counter(), time.process_time())
grid = read_elevation(elevation_paths(world.terrain))
read, read_peak = time.perf_counter() - start[0], peak()
del grid
start = (time.perf_counter(), time.process_time())
terrain_model(world)
ground = time.perf_counter() - start[0], time.process_time() - start[1]
print(json.dumps([read, (read_peak - before) / 1e6, *ground, (peak() - before) / 1e6]))
"""


def run(report):
    """`fallstreak bench elevation`."""
    report.table("Elevation models of about 10,800², best of 3", HEADINGS, rows(report))


HEADINGS = ("file", "MB", "read s", "its peak MB", "ground s", "processor s", "its peak MB")


def rows(report=None):
    """Make the files, open each in processes of its own; goals go to `report`, if there is one."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for name, make in KINDS.items():
            files = make(Path(folder))
            if files is None:
                continue
            # a scene names at most 256 files one by one, so many tiles by their folder
            names = files if len(files) < 10 else [folder]
            best = [min(column) for column in zip(*(_open(names) for _ in range(ROUNDS)), strict=True)]
            size = sum(path.stat().st_size for path in files) / 1e6
            found.append((name, f"{size:.0f}", *(f"{x:.0f}" if x > 20.0 else f"{x:.2f}" for x in best)))
            if report is not None:
                how = f"{SIDE}² samples, file to levels of the ground, best of {ROUNDS}, files in cache"
                report.add(f"elevation: {name} opens", best[2], "s", goal="< 2", how=how)
                above = "peak above a bare world's"
                report.add(f"elevation: {name}, memory", best[4], "MB", goal="< 500", how=above)
            for path in files:
                path.unlink()
    return found


def _open(names):
    names = json.dumps([str(name) for name in names])
    done = subprocess.run([sys.executable, "-c", _OPEN, names], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


@lru_cache(maxsize=1)
def _degree():
    """3601² heights with detail down to the sample, int16 m: they pack about as well as surveyed land."""
    rng = np.random.default_rng(7)
    i = np.linspace(0.0, 1.0, TILE + 1, dtype=np.float32)[:, None]
    heights = rng.normal(1500.0, 1.0, (TILE + 1, TILE + 1)).astype(np.float32)
    for octave in range(9):
        f = 6.28 * 2.0**octave
        a, b, c, d = rng.uniform(0.0, 6.28, 4)
        wave = np.sin(f * (i * np.cos(a) + i.T * np.sin(a)) + b) * np.sin(f * (i.T * np.cos(c) - i) + d)
        heights += 700.0 / 1.9**octave * wave
    return np.rint(heights).astype(np.int16)


def mountains(rows, columns):
    """Three degrees by three: one, mirrored at its edges."""
    i, j = (TILE - np.abs(np.arange(*span) % (2 * TILE) - TILE) for span in (rows, columns))
    return _degree()[i][:, j]


def geotiff(folder):
    """Tiles of 512², deflate, predictor 2."""
    try:
        import tifffile
    except ImportError:
        return None
    step = 3.0 / SIDE
    tags = [
        (33550, "d", 3, (step, step, 0.0), True),
        (33922, "d", 6, (0.0, 0.0, 0.0, 7.0, 48.0, 0.0), True),
        (34735, "H", 8, (1, 1, 0, 1, 1024, 0, 1, 2), True),
    ]

    def tiles():
        for top in range(0, SIDE, 512):
            band = mountains((top, min(top + 512, SIDE)), (0, SIDE))
            for left in range(0, SIDE, 512):
                tile = np.zeros((512, 512), np.int16)
                part = band[:, left : left + 512]
                tile[: part.shape[0], : part.shape[1]] = part
                yield tile

    path = folder / "tiled.tif"
    tifffile.imwrite(
        path, tiles(), shape=(SIDE, SIDE), dtype=np.int16, tile=(512, 512), compression="zlib", predictor=2,
        extratags=tags, photometric="minisblack",
    )  # fmt: skip
    return [path]


def srtm(folder):
    """Nine tiles of 3601²."""
    paths = []
    for i in range(3):
        for j in range(3):
            path = folder / f"N{47 - i:02d}E{7 + j:03d}.hgt"
            window = (i * TILE, i * TILE + TILE + 1), (j * TILE, j * TILE + TILE + 1)
            path.write_bytes(mountains(*window).astype(">i2").tobytes())
            paths.append(path)
    return paths


def zipped_srtm(folder):
    """The same, each in a zip archive."""
    import zipfile

    paths = []
    for path in srtm(folder):
        with zipfile.ZipFile(path.with_suffix(".hgt.zip"), "w", zipfile.ZIP_DEFLATED) as archive:
            archive.write(path, path.name)
        path.unlink()
        paths.append(path.with_suffix(".hgt.zip"))
    return paths


def picture(folder):
    """One 16-bit PNG and its sidecar."""
    from PIL import Image

    path = folder / "dem.png"
    parts = [mountains((top, top + 600), (0, SIDE)) for top in range(0, SIDE, 600)]
    Image.fromarray((np.concatenate(parts) + 5000).astype(np.uint16)).save(path, compress_level=6)
    path.with_suffix(".toml").write_text("west = 7\neast = 10\nsouth = 45\nnorth = 48\noffset = -5000\n")
    return [path]


def terrarium(folder):
    """1,764 tiles of 256² (10,752²); their heights only need to be as hard to unpack as others."""
    from PIL import Image

    def write(address):
        i, j = address
        rows, columns = (slice(n * 79, n * 79 + 256) for n in address)
        stored = (_degree()[rows, columns].astype(np.uint32) + 32768) << 8
        path = folder / "12" / str(2124 + j) / f"{1428 + i}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        rgb = np.stack([stored >> 16, stored >> 8 & 255, stored & 255], -1).astype(np.uint8)
        Image.fromarray(rgb).save(path)
        return path

    _degree()
    with ThreadPoolExecutor() as pool:
        return list(pool.map(write, ((i, j) for i in range(42) for j in range(42))))


KINDS = {
    "GeoTIFF, 512² deflate tiles": geotiff,
    "nine SRTM tiles": srtm,
    "nine SRTM tiles, zipped": zipped_srtm,
    "16-bit PNG": picture,
    "1,764 Terrarium tiles": terrarium,
}
