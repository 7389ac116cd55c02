"""Commands long enough for a file of their own; the command line imports each when it is called."""
