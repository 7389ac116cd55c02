"""`fallstreak doctor`: which GPUs there are, which one is used and why, and what to do when there is none."""

from __future__ import annotations

import platform
import sys

from rich.console import Console
from rich.markup import escape
from rich.table import Table


def doctor(adapter: str | None = None) -> int:
    """Print the state of the machine; returns the exit code: 0 when Fallstreak can render, 1 when not.

    Parameters
    ----------
    adapter : str, optional
        Part of the name of the adapter that would be asked for.
    """
    import fallstreak
    from fallstreak.gpu import CAPABILITIES, LIMITS, Device, NoAdapterError, adapters

    console = Console(soft_wrap=True)
    console.print(
        f"Fallstreak {fallstreak.__version__}, Python {platform.python_version()}, wgpu {_version('wgpu')}, "
        f"{platform.system()} {platform.machine()}"
    )
    found = adapters()
    if found:
        table = Table(title=None, box=None, pad_edge=False)
        for heading in ("adapter", "backend", "kind", "driver", "optional features", "usable"):
            table.add_column(heading, overflow="fold")
        for a in found:
            usable = "yes" if a.usable else "no: " + "; ".join(a.lacking)
            features = ", ".join(a.capabilities) or "none"
            table.add_row(*(escape(t) for t in (a.name, a.backend, a.kind, a.driver, features, usable)))
        console.print(table)
    try:
        device = Device.open(adapter)
    except NoAdapterError as error:
        print(f"fallstreak doctor: {error}", file=sys.stderr)
        return 1
    console.print(f"\nused: [bold]{escape(str(device.adapter))}[/bold], {device.why}")
    if device.adapter.kind == "CPU":
        console.print("This is a software adapter: pictures are the same, only slower than on a GPU.")
    table = Table(box=None, pad_edge=False)
    for heading in ("limit (WebGPU's default is what we use)", "used", "adapter has"):
        table.add_column(heading, justify="left" if heading.startswith("limit") else "right")
    native = device.adapter.native.limits
    for name in LIMITS:
        table.add_row(name, str(device.native.limits.get(name, LIMITS[name])), str(native.get(name, "?")))
    console.print(table)
    console.print("\noptional features:")
    for name in CAPABILITIES:
        there = name in device.capabilities
        state = f"there ({_PURPOSE[name][0]})" if there else f"not there ({_PURPOSE[name][1]})"
        console.print(f"  {name}: {state}")
    device.destroy()
    return 0


_PURPOSE = {
    "timestamp-query": ("GPU times per pass", "GPU times are not measured"),
    "float32-filterable": ("nothing needs it yet", "nothing needs it yet"),
    "depth-clip-control": ("nothing needs it yet", "nothing needs it yet"),
}


def _version(package: str) -> str:
    from importlib.metadata import version

    return version(package)
