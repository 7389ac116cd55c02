"""``python -m fallstreak`` is the command ``fallstreak``."""

import sys

from .cli import main

sys.exit(main())
