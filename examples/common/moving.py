# SPDX-License-Identifier: BSD-3-Clause
"""Bodies in motion: paths of tools as tables, and a reduced model beside the whole body on them."""
import os

import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

from bodies import add_scene_arguments, corners_of, on_surface, places, save_body
from materials import add_law_arguments, assign, check_laws
from pictures import HAND, PALE
from pipeline import Failure, output, update
from tables import save_csv, vtk_table

# Of the table of errors of Build Reduced Model: title and case, and what of it is told, in %.
CASES = {"one tool (%)": ("One tool at rest", "MaximumError"),
         "all tools (%)": ("All tools at rest", "MaximumError"),
         "motion, rms (%)": ("Motion", "RmsError"), "motion (%)": ("Motion", "MaximumError")}


def add_motion_arguments(parser):
    """The arguments that the functions below take."""
    add_scene_arguments(parser)
    add_law_arguments(parser, ["Neo-Hookean"])
    parser.set_defaults(young=5e3, poisson=0.4)
    parser.add_argument("--density", type=float, default=1060, help="of the body, kg/m³")
    parser.add_argument("--viscous-time", type=float, default=0.01, help="of its viscosity, s")
    parser.add_argument("--reach", type=float, help="how far a tool moves, m; by default 6 %% of "
                        "the longest side")
    parser.add_argument("--points", type=int, default=400, help="of a reduced model at the most")
    parser.add_argument("--training-paths", type=int, default=4, help="of a reduced model")
    parser.add_argument("--time-step", type=float, default=0.002, help="s")


def check_motion(args, grid, organ):
    """Tells what cannot be, and fills in what is not given."""
    if len(args.laws) != 1:
        raise Failure("one law at a time: --laws takes one here.")
    check_laws(grid, args)
    if args.density <= 0:
        raise Failure(f"--density is {args.density:g} kg/m³; without any nothing swings.")
    args.reach = args.reach or float(f"{0.06 * organ.size:.2g}")


def moving_body(grid, args, viscous_time=None):
    """The body with its material, density and viscosity; with the law Own with those it has."""
    body = save_body(grid, os.path.join(args.output, "scene.vtu"))
    law = args.laws[0]
    if law == "Own":
        return body
    more = {"Exponent": args.exponent} if law == "Fung" else {}
    viscous = args.viscous_time if viscous_time is None else viscous_time
    return update(assign(body, law, args.young, args.poisson, Density=args.density,
                         ViscousTime=viscous, **more))


def second_node(grid, node, organ, apart):
    """A corner of the surface that is not held, about so far from another, m, and as far as may be
    from where the body is held."""
    points = places(grid)
    good = np.zeros(len(points), bool)
    good[corners_of(grid)] = True
    good &= on_surface(grid)
    from_held = np.linalg.norm(points - organ.held_centre, axis=1)
    good &= from_held > organ.held_radius + 1.5 * organ.tip_radius
    distance = np.linalg.norm(points - points[node], axis=1)
    good &= distance > 2.5 * organ.tip_radius
    if not good.any():
        raise Failure("there is no place for a second tool: give --touched, or a smaller "
                      "--tip-radius.")
    # A metre too far away is as bad as one nearer to where it is held.
    return int(np.argmin(np.where(good, 2 * np.abs(distance - apart) - from_held, np.inf)))


def path_of(name, times, tools, held, args):
    """A reader of the table: the displacement (m) of each tool at the times (s), and whether it is
    held from there on."""
    columns = {"Time": times}
    for tool, (way, is_held) in enumerate(zip(tools, held)):
        columns.update({f"Tool{tool}_{axis}": way[:, k] for k, axis in enumerate("XYZ")})
        columns[f"Tool{tool}_Held"] = is_held
    rows = [dict(zip(columns, row)) for row in zip(*columns.values())]
    path = os.path.join(args.output, name + ".csv")
    save_csv(vtk_table(rows, list(columns)), path)
    return update(CSVReader(FileName=[path]))


def columns_of(proxy, port):
    """The columns of a table that a filter has made, as arrays or lists of texts."""
    table = proxy.GetClientSideObject().GetOutputDataObject(port)
    found = {}
    for i in range(table.GetNumberOfColumns()):
        array = table.GetColumn(i)
        texts = array.IsA("vtkStringArray")
        found[array.GetName()] = ([array.GetValue(k) for k in range(array.GetNumberOfValues())]
                                  if texts else vtk_to_numpy(array).copy())
    return found


def model_of(body, nodes, modes, organ, args):
    """A reduced model and a row of what it was measured to be."""
    model = update(BuildReducedModel(
        Input=body, ActiveNodes=nodes, TipRadius=organ.tip_radius, Reach=args.reach, Modes=modes,
        MaximumPoints=args.points, TrainingPaths=args.training_paths, TimeStep=args.time_step))
    errors = columns_of(model, 1)
    row = {"modes": errors["Modes"][0], "points": errors["Points"][0]}
    for title, (case, column) in CASES.items():
        if case in errors["Case"]:
            row[title] = 100 * errors[column][errors["Case"].index(case)]
    return model, row


def off(touched, whole):
    """The rms and the largest error of the forces, as shares of the largest force, in %."""
    names = [name for name in whole if name.startswith("Force")]
    largest = max(np.linalg.norm(whole[name], axis=1).max() for name in names)
    errors = []
    for name in names:
        right = np.array([np.interp(touched["Time"], whole["Time"], whole[name][:, k])
                          for k in range(3)]).T
        errors.append(np.linalg.norm(touched[name] - right, axis=1))
    return (100 * np.sqrt(np.mean(np.square(errors))) / largest,
            100 * np.max(errors) / largest)


def step_times(history):
    """The median and the time within which 99.9 % of the steps are, ms."""
    return tuple(1e3 * np.quantile(history["StepSeconds"][1:], share) for share in (0.5, 0.999))


def draw_motion(stage, touch, nodes, time, text, path):
    """The body at a time, with its shape at rest and a ball at each node that is touched."""
    update(touch)
    touch.UpdatePipeline(time)
    stage.view.ViewTime = time
    stage.clear()
    stage.show(stage.scene, PALE, Representation="Wireframe")
    stage.show_held()
    body = output(touch)
    displacement = vtk_to_numpy(body.GetPointData().GetArray("Displacement"))
    largest = np.linalg.norm(displacement, axis=1).max()
    for node in nodes:
        place = places(body)[node] + displacement[node]
        stage.show(Sphere(Center=list(place), Radius=0.02 * stage.size), HAND)
    warped = WarpByVector(Input=touch, Vectors=["POINTS", "Displacement"])
    stage.colour(stage.show(warped), ("POINTS", "Displacement", "Magnitude"), "Displacement (m)",
                 (0, max(largest, 1e-6)))
    stage.write(text)
    stage.save(path)
    Delete(warped)
