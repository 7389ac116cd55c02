"""What lies and grows on the ground, by country: each a WESL module and its float64 twin of the same name."""
