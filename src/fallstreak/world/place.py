"""Where on the planet the scene's anchor is: the origin of the east-north-up axes."""

from __future__ import annotations

from math import radians

from .fields import Number, Section, quantity


class Place(Section):
    """The anchor: world space has its origin there at sea level, x east, y north, z up."""

    latitude: Number = quantity(
        0.0, unit="deg", ge=-90.0, le=90.0, doc="Latitude of the anchor, north positive."
    )
    longitude: Number = quantity(
        0.0, unit="deg", ge=-180.0, le=360.0, doc="Longitude of the anchor, east positive."
    )

    @property
    def latitude_radians(self) -> float:
        """Latitude in radians."""
        return radians(self.latitude)

    @property
    def longitude_radians(self) -> float:
        """Longitude in radians."""
        return radians(self.longitude)
