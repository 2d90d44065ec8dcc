# SPDX-License-Identifier: BSD-3-Clause
"""What the scripts of the examples do at their beginning and end."""
import argparse
import sys

from paraview import servermanager
from paraview.simple import *

from pipeline import Failure


class Arguments(argparse.ArgumentParser):
    """Does not exit by itself: under mpiexec it would leave without the other ranks."""

    def __init__(self, prog, description):
        super().__init__(prog=prog, description=description, add_help=False,
                         formatter_class=argparse.ArgumentDefaultsHelpFormatter)
        self.add_argument("-h", "--help", action="store_true", help="show this and end")

    def error(self, message):
        raise Failure(f"{message} (see --help)")

    def read(self):
        """The arguments, or None where only help was asked for."""
        args = self.parse_args()
        if args.help:
            self.print_help()
            return None
        if not hasattr(servermanager.filters, "SolveEquilibrium"):
            raise Failure("the plugin Palpate is not loaded: set PV_PLUGIN_PATH to its folder.")
        return args


def run(name, main):
    """Calls main(); what goes wrong becomes one line."""
    def print_failure(kind, error, traceback):
        if issubclass(kind, Failure):
            print(f"{name}: {error}", file=sys.stderr)
        else:
            sys.__excepthook__(kind, error, traceback)

    # Not sys.exit(1): under mpiexec it would leave without the other ranks.
    sys.excepthook = print_failure
    main()
