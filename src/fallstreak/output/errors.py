"""The one exception of this room."""

from fallstreak.world.errors import UserError


class OutputError(UserError):
    """A file that cannot be written, or was asked for wrongly; the message is one sentence."""
