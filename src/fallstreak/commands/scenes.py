"""``fallstreak scenes``: what is shipped, in a table."""

from __future__ import annotations


def scenes() -> None:
    """List the shipped scenes: name, what is to be seen, where and when.

    Each can be rendered by its name, or built upon: ``extends = "jacksboro"``.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from fallstreak import load, scene_names

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for title in ("scene", "what is to be seen", "place", "time"):
        table.add_column(title, overflow="fold")
    for name in scene_names():
        world = load(name)
        where = f"{degrees(world.place.latitude, 'NS')}\n{degrees(world.place.longitude, 'EW')}"
        if world.planet.preset != "earth":
            where += f"\n{world.planet.preset.capitalize()}"
        when = f"{world.time:%Y-%m-%d}\n{world.time:%H:%M %Z}"
        table.add_row(f"[bold]{name}[/bold]", world.description, where, when)
    Console().print(table)


def degrees(angle: float, sides: str) -> str:
    """An angle as on a map: 84.2° W."""
    turned = (angle + 180.0) % 360.0 - 180.0
    return f"{abs(turned):.4g}° {sides[turned < 0]}"
