"""The film: night vision, exposure, white balance, tone map, sRGB, dither.

    tone = ToneMap(graph, world.film, size, bits=8, bloom="frame.bloom")      # writes frame.ldr

``frame.ldr`` is rgba8unorm, or for ``bits=16`` rgba16uint, whose read-back is the uint16 array of a 16-bit
PNG. Reads ``frame.resolved``, ``frame.exposure``, ``view`` and the bloom if it has a name. One pass, in one
form by day and another by night.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from fallstreak.gpu import EXPOSURE, FrameGraph, Struct

from . import model

if TYPE_CHECKING:
    from fallstreak.world import Film

FILM = Struct(
    "Film",
    [
        ("bloom", "f32", "share of the light that the lens spreads"),
        ("dither", "f32", "amplitude of the triangular noise, one code value or 0"),
        ("power", "f32", "of AgX's look: contrast"),
        ("saturation", "f32", "of AgX's look"),
        ("white", "mat3x3f", "makes daylight of the film's temperature white"),
    ],
)


class ToneMap:
    """The last pass of a picture.

    Parameters
    ----------
    graph : FrameGraph
        In which ``view``, ``picture``, ``frame.exposure`` and the bloom are declared.
    film : Film
        The world's; all of it but the exposure counts.
    size : (int, int)
    bits : 8 or 16
        Per channel of ``frame.ldr``.
    picture, bloom : str
        Textures; without bloom the lens is perfect.
    share : float, optional
        Of the light that is in `bloom`; the film's, if not given.
    """

    def __init__(
        self,
        graph: FrameGraph,
        film: Film,
        size: tuple[int, int],
        *,
        bits: Literal[8, 16] = 8,
        picture: str = "frame.resolved",
        bloom: str | None = None,
        share: float | None = None,
    ):
        graph.texture("frame.ldr", "rgba16uint" if bits == 16 else "rgba8unorm", size)
        self._uniform = graph.uniform("frame.film", FILM)
        power, saturation = model.AGX_LOOKS[film.look]
        dither = 1 / (2**bits - 1) if film.dither else 0.0
        self._uniform.set(
            bloom=film.bloom if share is None else share,
            dither=dither,
            power=power,
            saturation=saturation,
            white=model.white_balance(film.white_balance),
        )
        flags = {
            "AGX": film.tone_map == "agx",
            "NEUTRAL": film.tone_map == "neutral",
            "BLOOM": bloom is not None,
            "GRADED": (power, saturation) != (1.0, 1.0),
            "DEEP": bits == 16,
        }
        forms = {"frame.tonemap": (False, None)}
        if film.night_vision:
            # two forms, for a software adapter would do the eye's work by day too
            forms = {
                "frame.tonemap": (False, lambda: not _dark(graph)),
                "frame.tonemap.night": (True, lambda: _dark(graph)),
            }
        for name, (night, when) in forms.items():
            graph.render(
                name,
                "package::frame::tonemap",
                color=["frame.ldr"],
                bind={
                    "view": "view",
                    "film": "frame.film",
                    "picture": picture,
                    "exposure": "frame.exposure",
                    "bloom": bloom or "",
                    "linear": "sampler:linear-clamp",
                },
                structs=[EXPOSURE, FILM],
                flags={**flags, "NIGHT_VISION": night},
                when=when,
            )


def _dark(graph: FrameGraph) -> bool:
    """Whether anything in the picture may be dark enough for the eye's rods: the sun lower than 5 degrees."""
    light = graph.uniforms.get("sky.light")
    if light is None:
        return True
    up, sun = graph.uniforms["view"].record["up"], light.record["sun_direction"]
    return float(up @ sun) < 0.087
