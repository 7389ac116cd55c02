"""Skies, weather and worlds, rendered in real time on WebGPU."""
