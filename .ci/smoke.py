"""Smoke test of an installed wheel: `python .ci/smoke.py [BUILD]`, the expected engine build.

Simulates, writes a page to share, answers a browser as the studio, and makes a body, for which the
extra `make` is needed; without it, the sentence that names the command to install it.
"""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
import sysconfig
import tempfile
from importlib.util import find_spec
from pathlib import Path
from urllib.request import Request, urlopen

import flexor
from flexor._dispatch import engine_path

# Angles [rad] of the finger's joints at 5 N: `flexor simulate finger --constants calibrated`.
ANGLES = (0.3253484598804443, 0.1773547344754639, 0.039661380266032185)
COMMAND = Path(sysconfig.get_path("scripts")) / "flexor"


class Failure(Exception):
    """What does not work."""


def main() -> int:
    """Use every part that needs files or packages beside the engine."""
    checkout = Path(__file__).resolve().parent.parent
    try:
        if checkout in Path(flexor.__file__).parents and "site-packages" not in flexor.__file__:
            raise Failure(f"this is not an installed wheel: {flexor.__file__}")
        wanted = sys.argv[1] if len(sys.argv) > 1 else engine_path()
        if engine_path() != wanted:
            raise Failure(f"the engine is {engine_path()}, not {wanted}")
        with tempfile.TemporaryDirectory() as folder:
            done = [angles(), share(Path(folder)), body(Path(folder)), studio()]
    except Failure as failure:
        print(f"error: {failure}", file=sys.stderr)
        return 1
    print(f"flexor {flexor.__version__}, {engine_path()} engine: {'; '.join(done)}")
    return 0


def angles() -> str:
    """Simulate, and compare with the numbers above."""
    path = flexor.load("finger", "calibrated").equilibrium(force=[0, 1, 2, 3, 4, 5])
    error = max(abs(path.joint_angles[-1] - ANGLES))
    if not path.stable.all() or not error < 1e-9:
        raise Failure(f"joint angles are off by {error:.1e} rad")
    return f"angles within {error:.1e} rad"


def share(folder: Path) -> str:
    """Write a page; its scripts are files of the wheel."""
    file = folder / "finger.html"
    command("share", "finger", "--out", file)
    text = file.read_text(encoding="utf-8")
    if "WebGL" not in text or "</html>" not in text:
        raise Failure("the page to share is without its scripts")
    return f"a page of {len(text) / 1e6:.1f} MB"


def body(folder: Path) -> str:
    """Make a solid, or be told how to install what makes it."""
    file = folder / "body.stl"
    if find_spec("manifold3d") is None:
        said = command("export", "pneumatic-finger", "--body", file, code=2)
        if "flexor[make]" not in said or said.count("\n") != 1:
            raise Failure(f"without the extra, export says: {said}")
        return "no solid without the extra make"
    command("export", "pneumatic-finger", "--body", file)
    import trimesh

    mesh = trimesh.load_mesh(file)
    if not mesh.is_watertight or not mesh.volume > 0.0:
        raise Failure("the body is not a watertight solid")
    return f"a body of {mesh.volume / 1e3:.1f} mL"


def studio() -> str:
    """Start the studio; get its page, and one path."""
    vary = "exosuit.length=8 cm:11 cm"
    words = [COMMAND, "studio", "pneumatic-finger", "--vary", vary, "--no-open", "--port", "0"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    try:
        assert process.stdout is not None
        said = process.stdout.readline()
        address = re.search(r"http://\S+", said)
        if address is None:
            raise Failure(f"the studio says: {said}")
        with urlopen(address[0], timeout=60) as answer:
            text = answer.read().decode()
        if "</html>" not in text or "studio" not in text:
            raise Failure("the studio's page is incomplete")
        request = Request(
            f"{address[0]}api/solve",
            json.dumps({"values": [10.0], "loads": [60.0]}).encode(),
            {"Content-Type": "application/json"},
        )
        with urlopen(request, timeout=60) as answer:
            plots = json.load(answer)["design"]["plots"]
        shown = next(plot["series"] for plot in plots if plot["title"] == "Angles")
        path = flexor.load("pneumatic-finger").equilibrium()
        expected = [math.degrees(angle) for angle in path.joint_angles[-1]]
        found = [each["values"][-1] for each in shown if each["name"].startswith("angle.")]
        if not all(abs(a - b) < 1e-6 for a, b in zip(found, expected, strict=True)):
            raise Failure(f"the studio shows angles of {found} instead of {expected} degrees")
    finally:
        process.terminate()
        process.wait()
    return "the studio answers"


def command(*words: str | Path, code: int = 0) -> str:
    """Run the installed command; return what it says of errors."""
    done = subprocess.run([COMMAND, *words], capture_output=True, text=True, check=False)
    if done.returncode != code:
        raise Failure(f"flexor {words[0]} ended with {done.returncode}: {done.stderr}")
    return done.stderr


if __name__ == "__main__":
    sys.exit(main())
