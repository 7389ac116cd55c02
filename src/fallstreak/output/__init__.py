"""What leaves the house: pictures, float layers, arrays and sequences.

Every file carries its metadata (scene, time, frame, seed, version, adapter, ...) and is written to a hidden
file beside its place, then renamed: whoever looks finds a whole file or none. Nothing in a file differs
between two runs of one command (no wall clock, no timing), so that a resumed sequence is byte for byte the
uninterrupted one.

| suffix | holds | units |
|---|---|---|
| `.png` | the finished picture, 8 or 16 bit | sRGB (display-referred) |
| `.exr` | R G B, Z, N.X N.Y N.Z, albedo.R G B, motion.X Y, clouds.A as float32 | cd/m², metres, pixels |
| `.npz` | hdr, depth, normal, albedo, motion, clouds, ldr, metadata | the same |

Depth is the distance from the camera along the ray of the pixel, in metres; the sky is at infinity.
"""

from fallstreak.output.errors import OutputError
from fallstreak.output.layers import LAYERS, FrameLike, layers_of
from fallstreak.output.metadata import describes, is_whole, read_metadata, world_digest
from fallstreak.output.png import write_png
from fallstreak.output.save import FORMATS, save

__all__ = [
    "FORMATS",
    "LAYERS",
    "FrameLike",
    "OutputError",
    "describes",
    "is_whole",
    "layers_of",
    "read_metadata",
    "save",
    "world_digest",
    "write_png",
]
