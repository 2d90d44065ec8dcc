# SPDX-License-Identifier: BSD-3-Clause
"""How fast may a hand move over an organ whose space is explored while it is touched?

A hand palpates at random and is followed in real time by explorers on this machine: the share of
the ticks in computed cells, and how wrong the force is there and beside them, against solves from
outside. Other numbers of cores are simulated by the same strategy, from what the configurations of
a part of the organ have taken.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvpython online.py
    pvpython online.py --speeds 30 --seconds 5 --explorers 1
    pvpython online.py organ.stl --scale 0.001 --tool-radius 0.006 --depth 0.005
    pvpython online.py scene.vtu --laws Own --explorers 1 3 7

A .vtu scene keeps its points `Fixed`; its materials are replaced, but for the law Own. The results
go to the folder `out`: table.csv, table.md, simulated.csv, charts (.png), and the space of the part
that was explored beforehand (.palpate).
"""
import csv
import os
import subprocess
import sys

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

from paraview.simple import *

from bodies import add_scene_arguments, read_scene, save_body
from charts import Curve, chart
from materials import add_law_arguments, check_laws, scene_of
from pipeline import Failure, field, output, update
from pressing import sphere
from script import Arguments, run
from tables import save_csv, save_table, vtk_table

PROGRAMS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "build", "bin")
# As the programs name them.
SPEED, KNOWN = "hand (mm/s)", "in computed cells (%)"
COLUMNS = {"explorers": ".0f", SPEED: ".0f", "state (ms)": ".0f", KNOWN: ".3g",
           "median error (%)": ".2g", "error of 90 % (%)": ".2g", "force from around (%)": ".3g",
           "median error around (%)": ".2g", "error of 90 % around (%)": ".2g",
           "usual force (N)": ".2g",
           "median wait (s)": ".2f", "longest wait (s)": ".2f", "first cell (s)": ".2f"}
# That are simulated, and of them those that are drawn.
CORES, DRAWN = (1, 2, 4, 8, 32, 128, 1024), (1, 2, 8, 32, 1024)


def arguments():
    parser = Arguments("online.py", __doc__.splitlines()[0])
    add_scene_arguments(parser)
    add_law_arguments(parser, ["Neo-Hookean"])
    parser.set_defaults(elements=1000, poisson=0.4, young=5e3)
    parser.add_argument("--tool-radius", type=float, default=0.01, help="of the sphere, m")
    parser.add_argument("--depth", type=float, default=0.008,
                        help="how deep the sphere goes into the body at rest, m")
    parser.add_argument("--spacing", type=float, default=0.008, help="of the check-points, m")
    parser.add_argument("--speeds", type=float, nargs="+", default=[10, 30, 100, 200, 400],
                        help="of the hand, mm/s")
    parser.add_argument("--explorers", type=int, nargs="+", default=[1, 2],
                        help="how many there are on this machine")
    parser.add_argument("--seconds", type=float, default=20, help="of each hand")
    parser.add_argument("--extent", type=float, default=0.08,
                        help="how far the hand goes from the place that is touched, m")
    parser.add_argument("--region", type=float, default=0.03, metavar="RADIUS", help="of the part "
                        "whose configurations tell what a state takes, m")
    parser.add_argument("--programs", default=os.path.normpath(PROGRAMS),
                        help="the folder of the programs")
    return parser


def rows_of(args, path, *arguments):
    """What palpate-follow says of the space in a file, row by row."""
    program = os.path.join(args.programs, "palpate-follow")
    if not os.path.isfile(program):
        raise Failure(f"there is no {program}; build Palpate with PALPATE_WITH_EXPLORERS, or say "
                      "with --programs where it is.")
    with subprocess.Popen([program, path, "--speeds", *map(str, args.speeds), "--extent",
                           str(1e3 * args.extent), "--seconds", str(args.seconds),
                           *map(str, arguments)],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        for row in csv.DictReader(process.stdout):
            yield {name: float(value) for name, value in row.items()}
        trouble = process.stderr.read().strip()
    if process.returncode != 0:
        raise Failure(trouble)


def explore_part(scene, organ, args):
    """The file of a space of a part of the organ, and how many configurations it has."""
    path = os.path.join(args.output, "part.palpate")
    space = PrecomputeStateSpace(Input=scene, Depth=args.depth, Spacing=args.spacing,
                                 BeginAt=list(organ.place), FileName=path, History="Flat",
                                 **sphere(args.tool_radius))
    space.UseToolRegion, space.ToolRegion = 1, "Sphere"
    space.ToolRegion.Center, space.ToolRegion.Radius = list(organ.place), args.region
    count = field(output(update(space)), "NumberOfConfigurations")[0]
    Delete(space)
    return path, count


def follow(path, args):
    """The rows of hands that are followed in real time."""
    rows = []
    for row in rows_of(args, path, "--explorers", *args.explorers):
        print(f"{row['explorers']:.0f} explorers, {row[SPEED]:g} mm/s: {row[KNOWN]:.3g} % of the "
              "ticks in computed cells", flush=True)
        rows.append(row)
    return rows


def numbers_of(rows):
    """The numbers of explorers."""
    return sorted({row["explorers"] for row in rows})


def draw_shares(rows, simulated, path):
    curves = [Curve(f"{explorers:.0f} on this machine",
                    [(row[SPEED], row[KNOWN]) for row in rows if row["explorers"] == explorers],
                    colour, 0) for colour, explorers in enumerate(numbers_of(rows))]
    curves += [Curve(f"{cores:.0f} simulated",
                     [(row[SPEED], row[KNOWN]) for row in simulated if row["cores"] == cores],
                     len(curves) + colour, 1) for colour, cores in enumerate(DRAWN)]
    chart("A hand that is followed", "speed of the hand (mm/s)", "% of the ticks in computed cells",
          curves, path, logarithmic=(True, False))


def draw_errors(rows, path):
    most = max(numbers_of(rows))
    rows = [row for row in rows if row["explorers"] == most]
    curves = []
    for colour, (name, share, around) in enumerate((("in computed cells", KNOWN, ""),
                                                    ("beside them", "force from around (%)",
                                                     " around"))):
        for style, title in enumerate(("median error", "error of 90 %")):
            found = [(row[SPEED], row[f"{title}{around} (%)"]) for row in rows
                     if row[share] > 0 and row[f"{title}{around} (%)"] > 0]
            if found:
                curves.append(Curve(f"{name}: {title}", found, colour, style))
    chart(f"Error of the force, {most:.0f} explorers", "speed of the hand (mm/s)",
          "% of a usual force", curves, path)


def main():
    args = arguments().read()
    if args is None:
        return
    if len(args.laws) != 1:
        raise Failure("one law at a time: --laws takes one here.")
    if min(args.speeds) <= 0 or min(args.explorers) < 1 or not args.seconds > 0:
        raise Failure("--speeds, --explorers and --seconds must be more than 0.")
    grid, _, organ = read_scene(args)
    check_laws(grid, args)
    body = save_body(grid, os.path.join(args.output, "scene.vtu"))
    path, count = explore_part(scene_of(body, args.laws[0], args), organ, args)
    rows = follow(path, args)
    simulated = list(rows_of(args, path, "--simulated", *CORES))
    save_csv(vtk_table(simulated, simulated[0]), os.path.join(args.output, "simulated.csv"))
    save_table(rows, COLUMNS,
               ["Errors are those of the force against solves from outside, in per cent of the "
                "usual force, that nine tenths of the ticks stay below.",
                f"A configuration of the part that was explored beforehand ({count:.0f} of them) "
                f"has taken {simulated[0]['state (ms)']:.0f} ms."], args.output)
    if not os.environ.get("DISPLAY"):
        print("online.py: no charts, there is no display (xvfb-run -a gives one).", flush=True)
        return
    draw_shares(rows, simulated, os.path.join(args.output, "followed.png"))
    draw_errors(rows, os.path.join(args.output, "error_speed.png"))


if __name__ == "__main__":
    run("online.py", main)
