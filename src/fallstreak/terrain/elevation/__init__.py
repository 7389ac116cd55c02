"""Elevation files → one grid of heights that knows where it lies and is read by windows.

One file per format: `npz`, `geotiff` (with `tiff_codecs` and `lzw`), `hgt`, `png`, `terrarium`; `files`
chooses among them, `mosaic` and `overlay` join several. `raster` reads any of them piece by piece, `grid`
places the samples on the planet, `mips` keeps its levels and windows, `voids` fills what is unknown and
`coverage` tells what is too wide for that. Heights are metres above sea level; samples without one (nodata,
NaN, below −12 km or above 30 km) are filled from around, and how many they were is in `Overview.unknown`.
"""

from .files import read_elevation
from .grid import ElevationGrid, Overview
from .voids import bilinear, fill_voids

__all__ = ["ElevationGrid", "Overview", "bilinear", "fill_voids", "read_elevation"]
