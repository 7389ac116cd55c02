"""The sky: air, sun, moon and stars of a place at a time, in cd/m² and lux.

What it is: `Sky` (passes.py) puts tables, the drawing of the sky and `sky.irradiance` into a frame graph;
lookup.wesl is what other systems ask. `air`, `spectrum`, `model`, `tables` are the air on the CPU;
`ephemeris`, `light`, `stars`, `moon` are what stands above it.

Source: S. Hillaire, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique" (EGSR 2020) for
the tables and the multiple scattering; E. Bruneton (2017) for the media; mappings, bands and quadrature are
our own. docs/sky.md and docs/night.md say which, and how far they hold.

Limits: one aerosol and one gas, each falling off exponentially, with an ozone layer; scattering beyond the
first is alike in all directions; rays are straight in the air; mountains cast no shadow into it.

Cost: four tables of the air once; the view, the aerial perspective and the irradiance each frame.
"""
