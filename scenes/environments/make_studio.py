#!/usr/bin/env python3
"""Writes studio.hdr beside itself: a dim room with a warm window, a cool soft box and a small lamp.

Lat-long as docs and design say: row 0 the zenith, the centre column looks along +x, left of it +y.
Radiance RGBE without run lengths, so that no library is needed. Soft edges; values in W/(sr m^2).
"""
import math
import pathlib

WIDTH, HEIGHT = 256, 128

# azimuth, elevation, half width, half height (degrees), edge (degrees), radiance
PANELS = [
    (-60, 38, 22, 16, 4, (11.0, 9.8, 8.2)),    # window
    (165, 25, 12, 30, 4, (2.6, 3.2, 4.2)),     # soft box behind
    (-150, 55, 5, 5, 2, (30.0, 30.0, 30.0)),   # lamp
]


def smooth_step(x):
    x = min(1.0, max(0.0, x))
    return x * x * (3 - 2 * x)


def radiance(azimuth, elevation):
    up = smooth_step((elevation + 10) / 60)
    colour = [0.10 + 0.25 * up, 0.10 + 0.27 * up, 0.11 + 0.32 * up]
    if elevation < 0:
        colour = [c * (0.55 + 0.45 * smooth_step(1 + elevation / 12)) for c in colour]
    for a, e, half_width, half_height, edge, panel in PANELS:
        across = abs((azimuth - a + 180) % 360 - 180) - half_width
        along = abs(elevation - e) - half_height
        cover = smooth_step(0.5 - across / edge) * smooth_step(0.5 - along / edge)
        colour = [c + cover * p for c, p in zip(colour, panel)]
    return colour


def rgbe(colour):
    mantissa, exponent = math.frexp(max(colour))
    scale = mantissa * 256 / max(colour)
    return bytes([int(c * scale) for c in colour] + [exponent + 128])


def main():
    pixels = bytearray()
    for y in range(HEIGHT):
        for x in range(WIDTH):
            azimuth = 180 - 360 * (x + 0.5) / WIDTH
            elevation = 90 - 180 * (y + 0.5) / HEIGHT
            pixels += rgbe(radiance(azimuth, elevation))
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n"
    pathlib.Path(__file__).with_name("studio.hdr").write_bytes(header.encode() + bytes(pixels))


main()
