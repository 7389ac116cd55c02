"""How one frame is composed: G-buffer, light on surfaces, time, exposure, lens and film.

`gbuffer` declares what surfaces say of themselves; `lighting` turns that into luminance in ``frame.hdr``,
where the sky adds itself; `temporal` (moving pictures) or `accumulate` (stills) resolve it into
``frame.resolved``; `exposure` meters it; `bloom` is the lens and `tonemap` the film, which gives
``frame.ldr``. `pipeline` puts these in order. `model` is the same arithmetic on the CPU, with the sources.
Costs and limits: docs/frame.md.
"""
