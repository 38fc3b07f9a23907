"""Bundle the parts of three.js that the viewer uses: `python .ci/three.py`, which needs npm.

Versions are pinned, so that the result is the same file. It is committed; nobody who builds or uses
Flexor needs npm.
"""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

THREE, ESBUILD = "0.187.0", "0.28.2"
ASSETS = Path(__file__).resolve().parent.parent / "python" / "flexor" / "viewer" / "assets"
ENTRY = """\
export {
  BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, HemisphereLight, Mesh,
  MeshLambertMaterial, PerspectiveCamera, Scene, Spherical, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
"""
BUNDLE = (
    *("--bundle", "--minify", "--format=iife", "--global-name=THREE"),
    *("--legal-comments=none", "--charset=ascii"),
)


def main() -> None:
    """Write the bundle and its licence among the viewer's assets."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "package.json").write_text("{}")
        (folder / "entry.js").write_text(ENTRY)
        packages = (f"three@{THREE}", f"esbuild@{ESBUILD}")
        install = ("npm", "install", "--silent", "--no-audit", "--no-fund", *packages)
        subprocess.run(install, cwd=folder, check=True)
        banner = f"--banner:js=/* three.js {THREE}, MIT licence (LICENSE-three) */"
        out = f"--outfile={ASSETS / 'three.min.js'}"
        bundle = ("npx", "esbuild", "entry.js", *BUNDLE, banner, out, "--log-level=warning")
        subprocess.run(bundle, cwd=folder, check=True)
        licence = folder / "node_modules" / "three" / "LICENSE"
        (ASSETS / "LICENSE-three").write_bytes(licence.read_bytes())


if __name__ == "__main__":
    main()
