"""How much work a frame may cost, as plain data: each system's owner adds the fields of that system."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Quality:
    """What a quality preset fixes; sizes are texels, steps are samples along a ray."""

    name: str
    # sky
    sky_view_size: tuple[int, int] = (192, 108)
    sky_view_steps: int = 30
    aerial_size: tuple[int, int, int] = (32, 32, 32)
    aerial_steps: int = 1  # samples per slice
    transmittance_size: tuple[int, int] = (256, 64)
    multiscattering_size: tuple[int, int] = (32, 32)
    # terrain
    terrain_error_px: float = 1.5  # greatest error of a node's shape on the screen
    terrain_grid: int = 32  # quads along a node's side
    terrain_spacing: float = 0.25  # m between the finest samples; a power of two
    terrain_texel_px: float = 2.0  # width of a sample on the screen, as far as the windows allow
    terrain_tiles: int = 24  # width of the clipmap's windows at most, in tiles of 32 samples
    terrain_detail: int = 3  # of materials: 1 plain, 2 without visible tiles, 3 also on walls
    terrain_planet_octaves: int = 8  # of noise on the globe beyond the terrain
    # vegetation
    vegetation_radius: float = 1200.0  # m, how far trees stand; shrubs and stones a third of it
    vegetation_pixels: tuple[float, float] = (320.0, 100.0)  # lower ones are coarse meshes, impostors
    # clouds
    cloud_scale: int = 1  # pixels of the picture to one of the clouds, along a side
    cloud_cells: int = 128  # along a side of each layer's window: a cell may hold one cloud
    cloud_shadow: int = 192  # texels along a side of each map of the clouds' shadows
    cloud_puffs: int = 14000  # in sight, about
    cloud_atlas: int = 4096  # texels along a side of the atlas of sphere clouds
    # its sections, largest first: (texels along a side, how many)
    cloud_sections: tuple[tuple[int, int], ...] = ((512, 16), (192, 64), (64, 768), (16, 4096))
    cloud_tiles: float = 256.0  # of 16 x 16 texels, drawn anew in a frame
    cloud_near: int = 1  # texels of the clouds' picture to one of clouds about the camera, along a side
    # shadows
    shadow_wide: bool = True  # 3 x 3 bilinear samples of the maps of things; else one
    # frame
    bloom_first: int = 1  # finest level of glare, 2^-n of the picture's size: 1 or 2
    bloom_levels: int = 9  # at most; the widest is about 8 pixels high
    temporal: bool = True  # temporal anti-aliasing in sequences
    temporal_fast: bool = False  # by fewer taps: half the cost, a little softer when the camera moves
    default_samples: int = 4  # accumulated frames of a still when --samples is not given


_HIGH = Quality("high")

QUALITY: dict[str, Quality] = {
    "low": replace(
        _HIGH,
        name="low",
        sky_view_size=(128, 72),
        sky_view_steps=20,
        aerial_size=(16, 16, 16),
        transmittance_size=(128, 32),
        terrain_error_px=4.0,
        terrain_grid=16,
        terrain_spacing=0.5,
        terrain_detail=1,
        terrain_texel_px=2.5,
        terrain_tiles=16,
        terrain_planet_octaves=5,
        vegetation_radius=300.0,
        vegetation_pixels=(700.0, 220.0),
        cloud_scale=2,
        cloud_atlas=1024,
        cloud_sections=((128, 16), (64, 64), (32, 256), (16, 2048)),
        cloud_tiles=32.0,
        cloud_near=2,
        cloud_cells=96,
        cloud_shadow=96,
        cloud_puffs=7000,
        shadow_wide=False,
        bloom_first=2,
        bloom_levels=6,
        temporal_fast=True,
        default_samples=1,
    ),
    "medium": replace(
        _HIGH,
        name="medium",
        cloud_atlas=2048,
        cloud_sections=((256, 24), (128, 64), (64, 256), (16, 4096)),
        cloud_tiles=96.0,
        cloud_shadow=128,
        cloud_puffs=10000,
        terrain_error_px=2.5,
        terrain_detail=2,
        terrain_tiles=20,
        vegetation_radius=700.0,
        vegetation_pixels=(400.0, 120.0),
    ),
    "high": _HIGH,
    "ultra": replace(
        _HIGH,
        name="ultra",
        cloud_shadow=320,
        cloud_puffs=18000,
        sky_view_size=(384, 216),
        sky_view_steps=40,
        aerial_size=(48, 48, 48),
        aerial_steps=2,
        terrain_error_px=0.8,
        terrain_texel_px=1.5,
        terrain_tiles=32,
        vegetation_radius=2000.0,
        vegetation_pixels=(200.0, 90.0),
        default_samples=32,
    ),
}
"""The presets of ``--quality``, from cheap to fine."""
