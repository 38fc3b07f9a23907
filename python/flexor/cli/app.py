"""The command line as a whole: which commands there are, and how they end."""

from __future__ import annotations

import errno
import sys
from typing import Annotated

import typer

from flexor.cli import (
    calibrate,
    compare,
    landscape,
    methods,
    optimize,
    presets,
    reproduce,
    rerun,
    sets,
    simulate,
)
from flexor.cli.console import complain
from flexor.cli.studies import LOST
from flexor.errors import ClusterError, InputError

app = typer.Typer(
    name="flexor",
    help="Design soft exosuits with the wearer in the loop.",
    epilog="Start with: flexor simulate finger --plot finger.png",
    add_completion=False,
    rich_markup_mode="markdown",
    context_settings={"help_option_names": ["-h", "--help"]},
)
# A new command is one file and one line here.
app.command("simulate")(simulate.simulate)
app.command("optimize")(optimize.optimize)
app.command("landscape")(landscape.landscape)
app.command("compare")(compare.compare)
app.command("rerun")(rerun.rerun)
app.command("calibrate")(calibrate.calibrate)
app.command("reproduce", hidden=True, context_settings=reproduce.ANYTHING)(reproduce.reproduce)
app.command("presets")(presets.presets)
app.command("sets")(sets.sets)
app.command("methods")(methods.methods)


# What a disk or a folder refuses, and no code can mend.
_OF_THE_DISK = tuple(
    getattr(errno, name)
    for name in ("ENOSPC", "EDQUOT", "EFBIG", "EROFS", "EACCES", "EPERM", "EIO")
    if hasattr(errno, name)
)


def _version(wanted: bool) -> None:
    if wanted:
        import flexor

        print(f"flexor {flexor.__version__}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def root(
    context: typer.Context,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Design soft exosuits with the wearer in the loop."""
    if context.invoked_subcommand is None:
        print(context.get_help())


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and leave with its exit code.

    Parameters
    ----------
    arguments : list of str, optional
        What follows `flexor`; by default what the shell gave.

    Notes
    -----
    Exit codes: 0 done, 1 done but something did not work out (a load step without equilibrium), 2
    input that cannot be used, 3 the cluster was lost on the way, 130 interrupted.
    """
    try:
        code = app(args=arguments, prog_name="flexor", standalone_mode=False)
    except InputError as error:
        complain(str(error))
        code = 2
    except OSError as error:
        if error.errno not in _OF_THE_DISK:
            raise
        where = f'"{error.filename}"' if error.filename else "a file"
        complain(f"{where} cannot be written or read: {(error.strerror or str(error)).lower()}.")
        code = 2
    except ClusterError as error:
        complain(str(error))
        code = LOST
    except typer.TyperException as error:
        said = error.format_message()
        complain(said if said.endswith((".", "?")) else f"{said}.")
        code = error.exit_code
    except (KeyboardInterrupt, typer.Abort):
        complain("interrupted.")
        code = 130
    sys.exit(code if isinstance(code, int) else 0)
