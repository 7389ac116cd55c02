"""What is usual of each genus of clouds: heights, sizes, water, lifetime, and how its edges look.

Heights and thicknesses are those of middle latitudes (World Meteorological Organization, International Cloud
Atlas: low clouds below 2 km, middle ones 2 to 7 km, high ones 5 to 13 km). Extinction follows from liquid or
ice water content and effective radius, ``3 w / (2 rho r)`` (geometric optics, Q = 2); contents and radii are
typical ones of in-situ measurements (Rogers and Yau 1989, "A Short Course in Cloud Physics", chapters 5
and 6; Miles, Verlinde, Clothiaux 2000 for stratus; Heymsfield and McFarquhar 2002 for cirrus). Lifetimes: a
fair-weather cumulus lives for 10 to 30 minutes. The rest is looks.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Genus:
    """A genus.

    Attributes
    ----------
    base, thickness : float
        m above the sea; m from base to top of a cloud of ordinary size.
    water, drop : float
        g/m³ of water or ice in the middle of a cloud; effective radius, µm.
    ice : bool
    cell : float
        m, side of the lattice's cells, each of which may hold a cloud.
    jitter : float
        A cloud's middle lies within this part of a cell's side from the cell's middle.
    radius : (float, float)
        m, smallest and largest horizontal radius; small ones are more common.
    height : (float, float)
        Smallest and largest height over `thickness`; wide clouds are higher.
    base_spread : float
        m, highest minus lowest base.
    soft : float
        m over which matter sets in above the base.
    lifetime : float
        s; 0: for ever.
    clustering : float
        0 to 1, see `CloudLayer.clustering`.
    tile : float
        m, after which the coarse noise repeats; its largest lumps are a fourth of that.
    stretch : float
        Noise is so many times longer along the wind.
    shear : float
        m along the wind per m of height, by which noise leans back.
    amplitude : float
        Of the noise, in units of the field, whose surface lies at .25 and falls by 1 per half size.
    edge : float
        Width of the field's values over which density rises from 0 to full.
    look : (float, float, float, float)
        Shares of the noise's channels: billows, fBm, fine billows, fibres; their sum is 1.
    aligned : float
        0: clouds are turned by chance, 1: their x axis lies along the wind.
    wind : float
        m/s.
    """

    base: float
    thickness: float
    water: float
    drop: float
    cell: float
    radius: tuple[float, float]
    height: tuple[float, float]
    lifetime: float
    wind: float
    tile: float
    ice: bool = False
    jitter: float = 0.44
    base_spread: float = 60.0
    soft: float = 60.0
    clustering: float = 0.5
    stretch: float = 1.0
    shear: float = 0.0
    amplitude: float = 0.3
    edge: float = 0.12
    look: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    aligned: float = 0.0

    @property
    def extinction(self) -> float:
        """Extinction coefficient in the middle of a cloud, 1/m."""
        return 1.5e-3 * self.water / ((0.917 if self.ice else 1.0) * self.drop * 1e-3)

    @property
    def visible_depth(self) -> float:
        """Vertical optical depth from which on a place counts as covered: thin cirrus is seen, too."""
        return 0.1 if self.ice else 1.0


GENERA: dict[str, Genus] = {
    "cumulus_humilis": Genus(
        base=1000.0, thickness=380.0, water=0.25, drop=8.0, cell=1120.0, radius=(230.0, 980.0),
        height=(0.55, 1.3), lifetime=1200.0, wind=7.0, tile=1500.0, base_spread=50.0, soft=50.0,
        amplitude=0.42,
    ),
    "cumulus_mediocris": Genus(
        base=1000.0, thickness=1000.0, water=0.4, drop=9.0, cell=2000.0, radius=(400.0, 1700.0),
        height=(0.5, 1.3), lifetime=1800.0, wind=8.0, tile=2400.0, base_spread=70.0, soft=70.0,
        amplitude=0.42,
    ),
    "cumulus_congestus": Genus(
        base=900.0, thickness=3200.0, water=0.8, drop=11.0, cell=3900.0, radius=(850.0, 3100.0),
        height=(0.5, 1.3), lifetime=3000.0, wind=9.0, tile=4200.0, base_spread=100.0, soft=90.0,
        amplitude=0.42,
    ),
    "cumulonimbus": Genus(
        base=900.0, thickness=9800.0, water=1.0, drop=12.0, cell=19e3, radius=(9000.0, 15e3),
        height=(0.8, 1.12), lifetime=5400.0, wind=11.0, tile=11e3, base_spread=150.0, soft=150.0,
        clustering=0.7, amplitude=0.4,
    ),
    "stratocumulus": Genus(
        base=1100.0, thickness=480.0, water=0.3, drop=9.0, cell=1300.0, radius=(620.0, 1050.0),
        height=(0.7, 1.15), lifetime=5400.0, wind=8.0, tile=2300.0, base_spread=70.0, soft=90.0,
        clustering=0.3, edge=0.2, look=(0.6, 0.4, 0.0, 0.0),
    ),
    "stratus": Genus(
        base=300.0, thickness=330.0, water=0.25, drop=8.0, cell=2600.0, radius=(1500.0, 2300.0),
        height=(0.8, 1.15), lifetime=0.0, wind=5.0, tile=3600.0, base_spread=40.0, soft=110.0,
        clustering=0.9, amplitude=2.2, edge=1.0, look=(0.2, 0.8, 0.0, 0.0), jitter=0.5,
    ),
    "nimbostratus": Genus(
        base=700.0, thickness=3200.0, water=0.4, drop=12.0, cell=9000.0, radius=(5000.0, 7800.0),
        height=(0.85, 1.15), lifetime=0.0, wind=12.0, tile=9000.0, base_spread=150.0, soft=350.0,
        clustering=0.85, amplitude=1.5, edge=0.6, look=(0.35, 0.65, 0.0, 0.0), jitter=0.5,
    ),
    "altocumulus": Genus(
        base=3800.0, thickness=380.0, water=0.12, drop=8.0, cell=1800.0, radius=(1100.0, 1900.0),
        height=(0.75, 1.15), lifetime=3600.0, wind=16.0, tile=2600.0, base_spread=60.0, soft=70.0,
        clustering=0.8, amplitude=0.8, edge=0.3, look=(0.7, 0.3, 0.0, 0.0), aligned=0.92, stretch=0.4,
    ),
    "altostratus": Genus(
        base=3500.0, thickness=1500.0, water=0.1, drop=10.0, cell=7000.0, radius=(4000.0, 6200.0),
        height=(0.8, 1.15), lifetime=0.0, wind=18.0, tile=5500.0, base_spread=150.0, soft=350.0,
        clustering=0.9, stretch=5.0, amplitude=2.4, edge=1.3, look=(0.0, 0.7, 0.0, 0.3), aligned=0.95,
        jitter=0.5,
    ),
    "cirrus": Genus(
        base=8500.0, thickness=1300.0, water=0.03, drop=30.0, cell=8600.0, radius=(6600.0, 10e3),
        height=(0.7, 1.2), lifetime=7200.0, wind=32.0, tile=2600.0, ice=True, base_spread=500.0, soft=500.0,
        clustering=0.85, stretch=9.0, shear=4.0, amplitude=2.6, edge=0.9, look=(0.0, 0.2, 0.0, 0.8),
        aligned=0.94,
    ),
    "cirrocumulus": Genus(
        base=8000.0, thickness=280.0, water=0.04, drop=18.0, cell=2100.0, radius=(1400.0, 2400.0),
        height=(0.8, 1.15), lifetime=2400.0, wind=28.0, tile=1500.0, ice=True, base_spread=60.0, soft=80.0,
        clustering=0.85, amplitude=0.9, edge=0.4, look=(0.8, 0.0, 0.2, 0.0), aligned=0.92, stretch=0.45,
    ),
    "cirrostratus": Genus(
        base=7800.0, thickness=1300.0, water=0.012, drop=35.0, cell=16e3, radius=(9000.0, 14e3),
        height=(0.8, 1.15), lifetime=0.0, wind=30.0, tile=9e3, ice=True, base_spread=300.0, soft=500.0,
        clustering=0.85, stretch=9.0, shear=2.0, amplitude=3.0, edge=1.4, look=(0.0, 0.3, 0.0, 0.7),
        aligned=0.96, jitter=0.5,
    ),
}  # fmt: skip
"""By the names of `world.clouds.Genus`."""
