# SPDX-License-Identifier: MIT OR Apache-2.0
"""`assets/blender_scene.glb` is what its script makes, and every element in it can act."""

import sys

import bpy
import pytest
from conftest import REPOSITORY, Glb
from test_file import check

from bevy_coilover import ends
from bevy_coilover.properties import elements

sys.path.insert(0, str(REPOSITORY / "assets"))
COMMITTED = REPOSITORY / "assets" / "blender_scene.glb"


def close(one, other, where=""):
    """Equal but for rounding of the last digits, which differs between processors."""
    assert type(one) is type(other) or {type(one), type(other)} <= {int, float}, where
    if isinstance(one, dict):
        assert one.keys() == other.keys(), where
        for key in one:
            close(one[key], other[key], f"{where}.{key}")
    elif isinstance(one, list):
        assert len(one) == len(other), where
        for i, (a, b) in enumerate(zip(one, other)):
            close(a, b, f"{where}[{i}]")
    elif float in (type(one), type(other)):
        assert one == pytest.approx(other, rel=1e-5, abs=1e-5), where
    else:
        assert one == other, where


@pytest.mark.skipif(bpy.app.version < (5, 0, 0), reason="materials of an older Blender are others")
def test_the_committed_scene_is_what_its_script_makes(tmp_path):
    import blender_scene

    blender_scene.build()
    assert [(o.name, f) for o in elements(bpy.context.scene) for f in ends.faults(o.coilover)] == []
    blender_scene.write(tmp_path / "again.glb")
    again, committed = Glb(tmp_path / "again.glb"), Glb(COMMITTED)
    for glb in (again, committed):
        glb.json["asset"].pop("generator")
    close(again.json, committed.json)
    assert len(check(committed)) == 4 + 2 * 13 + 5
    assert COMMITTED.stat().st_size < 300_000
