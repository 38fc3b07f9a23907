"""Fit the library's silicones to tensile tests: `./dev fit-materials FOLDER`.

FOLDER holds the CSV files of the Soft Robotics Materials Database (Marechal et al., Soft Robotics
2020, doi 10.1089/soro.2019.0115, Open Database License 1.0), which are not shipped with Flexor.
Writes python/flexor/materials/fitted.toml.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from flexor.errors import InputError
from flexor.materials import Material
from flexor.materials.fit import Curve, Fit, fit_laws, mean_curve
from flexor.materials.library import FITTED
from flexor.materials.material import KINDS
from flexor.materials.tensile import TensileTest, read_test

STRAINS = (0.0, 2.0)  # what a soft exosuit's wall may reach
# Title and density [kg/m³] (specific gravity of the maker's data sheet) by file.
SILICONES = {
    "Dragon_Skin_10_MEDIUM": ("dragon-skin-10", "Dragon Skin 10 Medium silicone", 1070.0),
    "Dragon_Skin_20": ("dragon-skin-20", "Dragon Skin 20 silicone", 1080.0),
    "Dragon_Skin_30": ("dragon-skin-30", "Dragon Skin 30 silicone", 1080.0),
    "Ecoflex_00-30": ("ecoflex-00-30", "Ecoflex 00-30 silicone", 1070.0),
    "Ecoflex_00-50": ("ecoflex-00-50", "Ecoflex 00-50 silicone", 1070.0),
}
SOURCE = (
    "fitted to tensile tests of the Soft Robotics Materials Database (Marechal et al., Soft "
    "Robotics 2020, doi 10.1089/soro.2019.0115); density from the maker's data sheet"
)
HEADER = """\
# Written by ./dev fit-materials from the tensile tests of the Soft Robotics Materials Database
# (Marechal et al., Soft Robotics 2020, doi 10.1089/soro.2019.0115; ASTM D412, 450 mm/min, strain
# from the crosshead), up to 200 % of strain. In SI units: Pa, kg/m³.
"""


def table(name: str, title: str, density: float, test: TensileTest) -> str:
    """Fit a silicone and return its table."""
    curve = mean_curve([test], STRAINS)
    fits = fit_laws(curve, name=name)
    print(f"{title}: slack {curve.slack:.2%}")
    for fit in fits:
        print(
            f"  {fit.law:14s} cross-validated {fit.error:6.3g}, rms {fit.rms:6.2%}, largest "
            f"{fit.largest:6.2%}, E {fit.material.young_modulus / 1e3:6.1f} kPa"
            f"{'' if fit.stable else ', not stable'}"
        )
    return _written(fits[0], curve, name, title, density, test)


def _written(
    fit: Fit, curve: Curve, name: str, title: str, density: float, test: TensileTest
) -> str:
    low, high = fit.material.stretch_range or (1.0, 1.0)
    lines = [f"[{name}]", f'title = "{title}"', f'kind = "{fit.material.kind}"']
    rounded = {}
    for key in KINDS[fit.material.kind]:
        value = fit.material[key]
        rounded[key] = (
            tuple(float(f"{each:.5g}") for each in value)
            if isinstance(value, tuple)
            else float(f"{value:.5g}")
        )
        shown = list(rounded[key]) if isinstance(value, tuple) else rounded[key]  # type: ignore[arg-type]
        lines.append(f"{key} = {shown}")
    Material(name, fit.material.kind, rounded)
    lines += [
        f"density = {density}",
        f"strain_limit = {STRAINS[1]}",
        f"stretch_range = [{low:.4g}, {high:.4g}]",
        f"# stress within {fit.rms:.1%} (rms) and {fit.largest:.1%} (largest) of the measured; "
        f"{curve.slack:.1%} of slack removed;",
        f"# broke at {test.stretch[-1] - 1.0:.0%} and {test.stress[-1] / 1e6:.3g} MPa",
        f'source = "{SOURCE}"',
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Fit every silicone and write the library."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="with the CSV files of the database")
    folder = parser.parse_args().folder
    try:
        tests = {key: read_test(folder / f"{key}.csv") for key in SILICONES}
        tables = [table(*SILICONES[key], test) for key, test in tests.items()]
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    FITTED.write_text("\n".join([HEADER, *tables]), encoding="utf-8")
    print(f"written: {FITTED}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
