# SPDX-License-Identifier: MIT OR Apache-2.0
"""The add-on as a user gets it: built by Blender's own tool, installed as an extension, used in a new Blender."""

import os
import subprocess
import sys
from pathlib import Path

import bpy
from conftest import REPOSITORY, Glb

SOURCE = REPOSITORY / "blender" / "bevy_coilover"
TOOL = Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core" / "bl_pkg" / "cli" / "blender_ext.py"

USE = """
import os
import sys
import bpy

package, out = sys.argv[1:]
bpy.ops.preferences.extension_repo_add(name="Own", type="LOCAL") if not bpy.context.preferences.extensions.repos else None
repo = next(r for r in bpy.context.preferences.extensions.repos if not r.use_remote_url).module
bpy.ops.extensions.package_install_files(filepath=package, repo=repo, enable_on_install=True)
assert f"bl_ext.{repo}.bevy_coilover" in bpy.context.preferences.addons, list(bpy.context.preferences.addons.keys())
bpy.ops.mesh.primitive_cube_add(size=0.2)
bpy.ops.rigidbody.object_add()
bpy.ops.coilover.between(stiffness=77.0)
bpy.ops.export_scene.gltf(filepath=out)
sys.stdout.flush()
# The package bpy 4.2 crashes when Python takes it down in the ordinary way.
os._exit(0)
"""


def test_the_package_is_built_installed_and_used(tmp_path):
    subprocess.run([sys.executable, TOOL, "build", "--source-dir", SOURCE, "--output-dir", tmp_path], check=True)
    (package,) = tmp_path.glob("*.zip")
    told = subprocess.run([sys.executable, TOOL, "validate", package], capture_output=True, text=True)
    assert told.returncode == 0, told.stdout + told.stderr
    script, out = tmp_path / "use.py", tmp_path / "out.glb"
    script.write_text(USE)
    # A home of its own: nothing of the user's is read or written.
    home = {**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path / "home"), "HOME": str(tmp_path)}
    told = subprocess.run([sys.executable, script, package, out], env=home, capture_output=True, text=True)
    assert told.returncode == 0, told.stdout + told.stderr
    (content,) = Glb(out).elements().values()
    assert content["springDamper"]["stiffness"] == 77


def test_the_manifest_names_the_same_version_as_the_crate():
    import tomllib

    manifest = tomllib.loads((SOURCE / "blender_manifest.toml").read_text())
    crate = tomllib.loads((REPOSITORY / "Cargo.toml").read_text())["package"]
    assert manifest["version"] == crate["version"]
    assert manifest["blender_version_min"] == "4.2.0"
    for name in SOURCE.glob("*.py"):
        assert name.read_text().startswith("# SPDX-License-Identifier: MIT OR Apache-2.0"), name
        assert len(name.read_text().splitlines()) < 400, name
