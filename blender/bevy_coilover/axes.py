# SPDX-License-Identifier: MIT OR Apache-2.0
"""Between Blender's axes (Z up) and those of glTF (Y up)."""

import struct


def to_gltf(v):
    return (v[0], v[2], -v[1])


def to_blender(v):
    return (v[0], -v[2], v[1])


def short(x):
    """The shortest decimal number that is this number in single precision: 0.1, not 0.10000000149011612."""
    single = struct.unpack("f", struct.pack("f", x))[0]
    for digits in range(6, 10):
        text = float(f"{single:.{digits}g}")
        if struct.unpack("f", struct.pack("f", text))[0] == single:
            return text
    return single
