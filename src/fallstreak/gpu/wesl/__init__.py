"""A linker for WESL, the superset of WGSL with imports and conditions.

One WESL module per concept stands beside the Python that uses it; `link` turns an entry module and all it
reaches into one WGSL text.

>>> from fallstreak.gpu.wesl import link
>>> text = "@compute @workgroup_size(8, 8) fn main() {}"
>>> link("package::x", entries=["main"], resolve=lambda path: (text, "x.wesl")).entries["main"].workgroup_size
(8, 8, 1)

Source: the WESL specification (wesl-lang.dev: Imports, ConditionalTranslation, NameMangling) over the WGSL
specification (W3C). Supported:

- ``import`` with ``package::``, ``super::``, virtual packages, nested braces, ``as``, whole modules, and full
  paths anywhere in the code; modules may import each other in circles; an import is private to its module;
- ``@if``, ``@elif``, ``@else`` on directives, imports, declarations, struct members, parameters, statements
  and switch clauses; a flag that was not given is an error;
- virtual packages, ``constants`` (values from Python, or modules that Python chooses) and ``structs``
  (declarations from Python);
- ``enable``, ``requires`` and ``diagnostic`` of all modules, gathered at the top;
- only what the entry points reach is written; ``const_assert`` stays for every module that is reached.

Names of the entry module, of entry points and of overrides stay, those of others carry their module in front
(``sky_air_density``). The way back, from a line of WGSL or a message of the compiler to the ``.wesl`` file
and line, is kept in `Linked`.

Limits: no expression is parsed or typed, so everything but structure and names is left to the WGSL compiler,
whose message `Linked.translate_error` brings back to the source. Packages from other projects, generics and
re-exports (``public import``) are not part of it.
"""

from .errors import WeslError
from .interface import Binding, EntryPoint
from .library import package_resolver
from .link import link
from .linked import Linked

__all__ = ["Binding", "EntryPoint", "Linked", "WeslError", "link", "package_resolver"]
