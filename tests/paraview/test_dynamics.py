# SPDX-License-Identifier: BSD-3-Clause
"""SolveDynamics: bodies in motion, as the animation and the table of its steps show them."""

import math

import numpy
from paraview import servermanager
from paraview.simple import (AssignMaterial, CSVReader, SetBoundary, SolveDynamics,
                             SolveEquilibrium)
from support import (Messages, box_body, expect_error, expect_silence, fetch, field, message,
                     node_at, places, point_array, scene, source)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray

CONVERGED, NOT_CONVERGED, _, BUDGET_USED_UP, ABORTED = range(5)
INVERTED = 1  # of Flags
DENSITY = 1000.0
CORNER = [0.2, 0.1, 0.1]
# Of a box as that of support.py, m: above the middle of its top.
RADIUS = 0.04
ABOVE = numpy.array([0.11, 0.05, 0.1 + RADIUS + 0.02])


def held(body, **material):
    """A body held at x = 0."""
    material = {"Law": "Neo-Hookean", "Density": DENSITY} | material
    boundary = SetBoundary(Input=AssignMaterial(Input=body, **material), FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    return boundary


def paths(name, times, *tools):
    """A reader of a table: the places of each tool, m, at the times, s."""
    columns = ["Time"] + [f"Tool{tool}_{axis}" for tool in range(len(tools)) for axis in "XYZ"]
    rows = numpy.column_stack([times, *(numpy.asarray(tool) for tool in tools)])
    with open(name + ".csv", "w") as file:
        file.write(",".join(columns) + "\n")
        file.writelines(",".join(map(repr, map(float, row))) + "\n" for row in rows)
    return CSVReader(FileName=[name + ".csv"])


def at(dynamics, time):
    """The body at a time."""
    dynamics.UpdatePipeline(time)
    return servermanager.Fetch(dynamics)


def history(dynamics):
    """The columns of the table."""
    dynamics.UpdatePipeline()
    table = servermanager.Fetch(dynamics, idx=1)
    return {table.GetColumnName(i): vtk_to_numpy(table.GetColumn(i))
            for i in range(table.GetNumberOfColumns())}


def balance_error(table):
    """How far work is from what is stored and lost, as a share of the largest energy."""
    stored = sum(table[name] for name in ("KineticEnergy", "ElasticEnergy", "WeightEnergy",
                                          "ViscousEnergy"))
    error = numpy.abs(table["Work"] - table["Dissipated"] - (stored - stored[0])).max()
    return error / max(numpy.abs(table["Work"]).max(), numpy.ptp(table["ElasticEnergy"]))


def test_falling_bar():
    """A bar that is let go: its end falls freely until the wave of the held end is there. After
    twice that time it is farthest, g L^2/c^2, after four times it is back."""
    length, modulus, gravity, cells = 0.1, 10000.0, 1.0, 16
    body = source(box_body((cells, 1, 1), (length, length / 4, length / 4)), "bar")
    boundary = held(body, Law="Linear", YoungsModulus=modulus, PoissonsRatio=0)
    passage = length / math.sqrt(modulus / DENSITY)
    farthest = gravity * passage**2
    tip = node_at(boundary, [length, 0, 0])
    for settings in ({}, {"Integrator": "Generalised alpha", "SpectralRadius": 0.5}):
        dynamics = SolveDynamics(Input=boundary, BodyForce=[gravity, 0, 0], Settled=0,
                                 EndTime=4 * passage, FrameRate=20 / passage,
                                 TimeStep=passage / 200, **settings)
        dynamics.UpdatePipelineInformation()
        times = list(dynamics.TimestepValues)
        assert len(times) == 81 and times[0] == 0 and times[-1] == 4 * passage
        # Not in their order: each is asked for by itself.
        for step in (40, 18, 80, 10, 0):
            grid = expect_silence(lambda: at(dynamics, times[step]))
            fall = point_array(grid, "Displacement")[tip, 0]
            t = times[step]
            exact = gravity * {80: 0.0, 40: passage**2}.get(step, t**2 / 2)
            assert abs(fall - exact) < (1e-3 if step < 20 else 0.02) * farthest, (step, fall)
            assert field(grid, "Time")[0] == t and field(grid, "Outcome")[0] == CONVERGED
        table = history(dynamics)
        assert table["Time"][0] == 0 and abs(table["Time"][-1] - 4 * passage) < 1e-12
        assert numpy.allclose(table["StepLength"][1:], passage / 200, rtol=1e-6)
        assert balance_error(table) < 1e-3


def test_output():
    boundary = held(source(box_body(), "output"), ViscousTime=0.002, PronyModuli=[0.5],
                    PronyTimes=[0.02])
    nodes = [node_at(boundary, CORNER), node_at(boundary, [0.1, 0, 0.1])]
    way = paths("output", [0, 0.05, 0.1], [[0, 0, 0], [0.01, 0.005, 0], [0.01, 0.005, 0]],
                [[0, 0, 0], [0, 0, -0.004], [0, 0, 0]])
    dynamics = SolveDynamics(Input=boundary, ToolPaths=way, ActiveNodes=nodes, EndTime=0.15,
                             BodyForce=[0, 0, -9.81])
    grid = expect_silence(lambda: at(dynamics, 0.12))
    assert (places(grid) == places(fetch(boundary))).all()
    displacement = point_array(grid, "Displacement")
    # From where it rests under gravity.
    moved = displacement - point_array(at(dynamics, 0), "Displacement")
    assert numpy.abs(moved[nodes[0]] - [0.01, 0.005, 0]).max() < 1e-12
    assert numpy.abs(field(at(dynamics, 0), "ReactionForce")).max() < 1e-6
    assert (displacement[point_array(grid, "Fixed") == 1] == 0).all()
    assert field(grid, "ReactionForce").shape == (2, 3) and message(grid) == ""
    assert not grid.GetPointData().HasArray("ContactPressure")
    table = history(dynamics)
    assert list(table) == [
        "Time", "StepLength", "KineticEnergy", "ElasticEnergy", "WeightEnergy", "ViscousEnergy",
        "Dissipated", "Work", "Position0", "Force0", "Position1", "Force1", "MinimumDetF",
        "LocalError", "Residual", "Iterations", "Halvings", "Flags", "Outcome"]
    assert (table["Outcome"] == CONVERGED).all() and (table["Iterations"][1:] > 0).all()
    assert table["Dissipated"][-1] > 0 and (table["Residual"] <= 1e-8).all()
    assert 0 < table["MinimumDetF"].min() < 1
    assert numpy.allclose(table["Position0"][-1], [0.01, 0.005, 0], rtol=0, atol=1e-15)
    # Between two steps the force of the tools is between theirs.
    step = numpy.searchsorted(table["Time"], 0.12)
    low, high = sorted((table["Force0"][step - 1, 0], table["Force0"][step, 0]))
    assert low - 1e-9 <= field(grid, "ReactionForce")[0, 0] <= high + 1e-9


def test_settled_body_stays():
    """Under gravity it is at rest, and the force of the tool is the weight that it carries."""
    boundary = held(source(box_body(quadratic=False), "settled"))
    dynamics = SolveDynamics(Input=boundary, BodyForce=[0, 0, -9.81], EndTime=0.1)
    start, end = (point_array(at(dynamics, t), "Displacement") for t in (0, 0.1))
    assert numpy.abs(start).max() > 1e-3
    assert numpy.abs(end - start).max() < 1e-6 * numpy.abs(start).max()
    assert history(dynamics)["KineticEnergy"].max() < 1e-12


def test_tissues_differ():
    """While it falls freely each part has the energy of its own mass."""
    grid = box_body((16, 1, 1), (0.1, 0.025, 0.025))
    part = vtkDoubleArray()
    part.SetName("Part")
    for cell in range(grid.GetNumberOfCells()):
        bounds = grid.GetCell(cell).GetBounds()
        part.InsertNextValue(float(bounds[0] + bounds[1] > 0.1))
    grid.GetCellData().AddArray(part)
    row = "YoungsModulus 5000 PoissonsRatio 0.3 Density "
    energies = []
    for left, right in ((1000, 1000), (1000, 3000)):
        boundary = held(source(grid, "tissues"), RegionType="Table", RegionArray="Part",
                        Regions=["0", "Linear", row + str(left), "1", "Linear", row + str(right)])
        dynamics = SolveDynamics(Input=boundary, BodyForce=[1, 0, 0], Settled=0, EndTime=0.004,
                                 TimeStep=0.0002)
        energies.append(history(dynamics)["KineticEnergy"][-1])
    mass = 1000 * 0.1 * 0.025**2
    exact = [mass * total * 0.004**2 / 2 for total in (1, 2)]
    # Near the held end it does not fall: c t is a tenth of its length.
    assert 0.85 < energies[0] / exact[0] < 1
    assert abs((energies[1] - energies[0]) / (exact[1] - exact[0]) - 1) < 0.01


def test_two_tools():
    """In a linear body the motions of two tools add up; their order is that of the nodes."""
    boundary = held(source(box_body(quadratic=False), "two"), Law="Linear", ViscousTime=0.01)
    nodes = [node_at(boundary, CORNER), node_at(boundary, [0.1, 0, 0.1])]
    times = numpy.linspace(0, 0.2, 21)
    wave = numpy.sin(math.pi * times / 0.2)[:, None] ** 2
    moves = [wave * [0.01, 0.005, 0], wave * [0, 0.002, -0.006]]
    still = 0 * moves[0]
    forces = {}
    for name, tools in (("both", moves), ("first", [moves[0], still]), ("last", [still, moves[1]]),
                        ("swapped", moves[::-1])):
        order = nodes[::-1] if name == "swapped" else nodes
        dynamics = SolveDynamics(Input=boundary, ToolPaths=paths(name, times, *tools),
                                 ActiveNodes=order, EndTime=0.2)
        table = expect_silence(lambda: history(dynamics))
        forces[name] = [table["Force0"], table["Force1"]]
    size = numpy.abs(forces["both"]).max()
    for tool in (0, 1):
        added = forces["first"][tool] + forces["last"][tool]
        assert numpy.abs(forces["both"][tool] - added).max() < 1e-6 * size
        assert numpy.abs(forces["both"][tool] - forces["swapped"][1 - tool]).max() < 1e-6 * size


def test_contact_in_motion():
    """A sphere presses, slides, and stands still: then its force is that of the equilibrium."""
    boundary = held(source(box_body((8, 4, 4), quadratic=False), "contact"), ViscousTime=0.1)
    down, slide = numpy.array([0, 0, -0.03]), numpy.array([0.02, 0, 0])
    way = paths("contact", [0, 0.1, 0.2, 1],
                [ABOVE, ABOVE + down, ABOVE + down + slide, ABOVE + down + slide])
    rigid = {"Tool": "Sphere", "ToolRadius": RADIUS}
    dynamics = SolveDynamics(Input=boundary, ToolPaths=way, EndTime=1.5, TimeStep=0.001, **rigid)
    before, during, after = (expect_silence(lambda: at(dynamics, t)) for t in (0, 0.1, 1.5))
    assert (point_array(before, "ContactPressure") == 0).all()
    assert (field(before, "ReactionForce") == 0).all()
    assert point_array(during, "ContactPressure").max() > 0
    table = history(dynamics)
    # A quarter of it with half of the step: what the method itself damps.
    assert balance_error(table) < 0.005, balance_error(table)
    assert table["Dissipated"][-1] > 0.1 * table["Work"][-1]
    rest = fetch(SolveEquilibrium(Input=boundary, ToolPosition=list(ABOVE + down + slide), **rigid))
    force, exact = field(after, "ReactionForce")[0], field(rest, "ReactionForce")[0]
    assert numpy.linalg.norm(force - exact) < 1e-3 * numpy.linalg.norm(exact), (force, exact)
    pressure = point_array(rest, "ContactPressure")
    assert numpy.abs(point_array(after, "ContactPressure") - pressure).max() < 0.01 * pressure.max()
    # What the layer of contact and the cells do to the force is told, the first by the stiffness of
    # the contact alone, which is larger than that of a bar that bends too.
    for name in ("ContactLayerForce", "ContactMeshError"):
        assert (field(before, name) == 0).all(), name
    told, exact_told = (field(grid, "ContactLayerForce")[0] for grid in (after, rest))
    assert 1 < told / exact_told < 3, (told, exact_told, exact)
    errors = [field(grid, "ContactMeshError")[0] for grid in (after, rest)]
    assert errors[1] > 0 and abs(errors[0] / errors[1] - 1) < 0.01, errors


def test_contact_and_bonded_tools():
    """Two spheres press while a node is held; they begin in contact."""
    boundary = held(source(box_body((8, 4, 4), quadratic=False), "several"), ViscousTime=0.01)
    node = node_at(boundary, CORNER)
    deep = ABOVE + [0, 0, -0.025]
    below = [deep[0], deep[1], 0.1 - deep[2]]
    way = paths("several", [0, 0.05], [[0, 0, 0], [0.005, 0, 0]], [deep, deep], [below, below])
    dynamics = SolveDynamics(Input=boundary, ToolPaths=way, ActiveNodes=[node], Tool="Sphere",
                             ToolRadius=RADIUS, EndTime=0.1)
    table = expect_silence(lambda: history(dynamics))
    assert table["Force1"][0, 2] < -0.01 and table["Force2"][0, 2] > 0.01
    assert table["Force0"][-1, 0] > 0
    pressure = point_array(at(dynamics, 0.1), "ContactPressure")
    heights = places(at(dynamics, 0.1))[:, 2]
    assert pressure[heights > 0.0999].max() > 0 and pressure[heights < 0.0001].max() > 0
    assert field(at(dynamics, 0.1), "ContactLayerForce").shape == (2,)
    assert (field(at(dynamics, 0.1), "ContactMeshError") > 0).all()


def test_one_run_for_all_times():
    boundary = held(source(box_body(quadratic=False), "once"))
    dynamics = SolveDynamics(Input=boundary, BodyForce=[0, 0, -9.81], Settled=0, EndTime=0.2,
                             TimeStep=0.001)
    algorithm, told = dynamics.GetClientSideObject(), []
    table = history(dynamics)
    for time in (0.2, 0.1):
        at(dynamics, time)
    again = history(dynamics)
    assert all((table[name] == again[name]).all() for name in table)
    # Nothing is solved for any more: at most the pipeline tells that it begins and ends.
    observer = algorithm.AddObserver(
        "ProgressEvent", lambda *_: told.append(algorithm.GetProgress()))
    at(dynamics, 0.05)
    assert set(told) <= {0, 1}, told
    algorithm.RemoveObserver(observer)
    dynamics.EndTime = 0.1
    assert abs(history(dynamics)["Time"][-1] - 0.1) < 1e-12


def test_a_failed_run_fails_once():
    """At each time step the output bears the mark, and nothing is computed or said again."""
    boundary = held(source(box_body((2, 1, 1), quadratic=False), "failed once"))
    way = paths("failed once", [0, 0.1], [[0, 0, 0], [0.01, 0, 0]])
    broken = SetBoundary(Input=boundary, FixedBy="Array", FixedArray="missing")
    for body, word in ((boundary, "does not exist"), (broken, "missing")):
        dynamics = SolveDynamics(Input=body, ActiveNodes=[10**6], ToolPaths=way, EndTime=0.1)
        expect_error(lambda run=dynamics: run.UpdatePipeline(0.0), word)
        for time in (0.02, 0.06):
            expect_silence(lambda run=dynamics, at=time: run.UpdatePipeline(at))
            dynamics.UpdatePropertyInformation()
            assert dynamics.GetPropertyValue("ErrorCode") != 0
            output = dynamics.GetClientSideObject().GetOutputDataObject(0)
            assert word in output.GetFieldData().GetAbstractArray("Error").GetValue(0)
    # Mended, it runs.
    dynamics.Input, dynamics.ActiveNodes = boundary, [node_at(boundary, [0.2, 0.1, 0.1])]
    expect_silence(lambda: dynamics.UpdatePipeline(0.06))


def test_adaptive_steps():
    boundary = held(source(box_body(quadratic=False), "adaptive"), ViscousTime=0.005)
    node = node_at(boundary, CORNER)
    times = numpy.linspace(0, 0.1, 11)
    way = paths("adaptive", times, numpy.sin(math.pi * times / 0.1)[:, None] ** 2 * [0.01, 0, 0])
    lengths, ends = [], []
    for settings in ({"TimeStep": 1e-4}, {"TimeStep": 0.02, "StepTolerance": 1e-4}):
        dynamics = SolveDynamics(Input=boundary, ToolPaths=way, ActiveNodes=[node], EndTime=0.2,
                                 **settings)
        table = history(dynamics)
        lengths.append(table["StepLength"][1:])
        ends.append(point_array(at(dynamics, 0.05), "Displacement"))
    assert len(lengths[1]) < len(lengths[0]) / 4
    assert lengths[1].max() > 3 * lengths[1].min()
    assert numpy.abs(ends[1] - ends[0]).max() < 0.01 * numpy.abs(ends[0]).max()


def unfinished(prepare=None, **settings):
    """The run ends early: a warning, no error, and the body as it was last."""
    boundary = held(source(box_body(quadratic=False), "unfinished"))
    way = paths("unfinished", [0, 0.1], [[0, 0, 0], [-0.1, 0, 0]])
    dynamics = SolveDynamics(Input=boundary, ToolPaths=way, EndTime=0.2,
                             ActiveNodes=[node_at(boundary, [0.2, 0.05, 0.05])], **settings)
    if prepare:
        prepare(dynamics.GetClientSideObject())
    with Messages() as messages:
        end = at(dynamics, 0.2)
    assert messages.errors == 0 and messages.warnings == 1, messages.text
    assert message(end) in messages.text and message(end)
    table = history(dynamics)
    assert table["Time"][-1] < 0.19
    assert table["Outcome"][-1] == field(end, "Outcome")[0]
    assert (table["Outcome"][:-1] == CONVERGED).all()
    assert numpy.isfinite(point_array(end, "Displacement")).all()
    return field(end, "Outcome")[0]


def test_unfinished():
    assert unfinished(MaximumSeconds=1e-9) == BUDGET_USED_UP
    assert unfinished(MaximumIterations=1, MaximumHalvings=1) == NOT_CONVERGED
    assert unfinished(lambda algorithm: algorithm.AddObserver(
        "ProgressEvent", lambda *_: algorithm.SetAbortExecute(1))) == ABORTED


def test_extremes():
    """Each run ends converged or with a name and a warning, and each number of it is finite."""
    body = source(box_body((3, 2, 2), quadratic=False), "extremes")
    quadratic = source(box_body((2, 1, 1)), "extremes quadratic")
    # Of the material; how far the end is pulled, m, and in which time it is back, s.
    extremes = (
        ({"Law": "St. Venant-Kirchhoff", "ViscousTime": 0.001}, -0.12, 0.02),
        ({"PoissonsRatio": 0.4999, "ViscousTime": 0.001}, 0.02, 0.02),
        ({"PoissonsRatio": 0.499999, "ViscousTime": 0.001}, 0.02, 0.005),
        ({"ViscousTime": 0.001, "Density": 100 * DENSITY}, 0.03, 0.005),
        ({"ViscousTime": 10, "PronyModuli": [1], "PronyTimes": [10]}, 0.03, 0.005),
        ({"PronyModuli": [10], "PronyTimes": [0.001]}, 0.03, 0.005),
        ({"Law": "Fung", "ViscousTime": 0.001}, 0.05, 0.005),
        ({}, -0.18, 0.005))
    outcomes = []
    for material, pull, tap in extremes:
        of = quadratic if material.get("PoissonsRatio", 0) > 0.4 else body
        boundary = held(of, **material)
        times = numpy.linspace(0, tap, 9)
        way = paths("extremes", times,
                    numpy.sin(math.pi * times / tap)[:, None] ** 2 * [pull, 0, 0])
        dynamics = SolveDynamics(Input=boundary, ToolPaths=way, EndTime=2 * tap, TimeStep=0.001,
                                 ActiveNodes=[node_at(boundary, [0.2, 0.1, 0.1])])
        with Messages() as messages:
            end = at(dynamics, 2 * tap)
        outcome = field(end, "Outcome")[0]
        outcomes.append(outcome)
        table = history(dynamics)
        assert all(numpy.isfinite(column).all() for column in table.values()), material
        assert numpy.isfinite(point_array(end, "Displacement")).all(), material
        assert table["Outcome"][-1] == outcome, material
        # Inverted cells are a flag, which the message tells of.
        inverted = (table["Flags"] & INVERTED) != 0
        assert (inverted == (table["MinimumDetF"] <= 0)).all(), material
        assert inverted.any() == (material.get("Law") == "St. Venant-Kirchhoff"), material
        assert messages.errors == 0, messages.text
        assert messages.warnings == (outcome != CONVERGED or inverted.any()), messages.text
        assert message(end) in messages.text and (message(end) != "") == (messages.warnings == 1)
        assert ("inverted" in message(end)) == (outcome == CONVERGED and inverted.any())
        if outcome == CONVERGED:
            assert abs(table["Time"][-1] - 2 * tap) < 1e-12
    assert outcomes.count(CONVERGED) >= 6, outcomes


def test_solvers_agree():
    boundary = held(source(box_body(quadratic=False), "solvers"))
    node = node_at(boundary, CORNER)
    way = paths("solvers", [0, 0.05], [[0, 0, 0], [0.01, 0.005, 0]])
    forces = []
    for name in SolveDynamics(Input=boundary).GetProperty("LinearSolver").Available:
        # All ranks together where there are several.
        dynamics = SolveDynamics(Input=boundary, ToolPaths=way, ActiveNodes=[node], EndTime=0.1,
                                 LinearSolver=name, GroupUnknowns=0)
        forces.append(expect_silence(lambda: history(dynamics))["Force0"])
    assert len(forces) >= 3
    for force in forces:
        assert numpy.abs(force - forces[0]).max() < 1e-5 * numpy.abs(forces[0]).max()


def test_bad_input():
    boundary = held(source(box_body(quadratic=False), "bad"))
    node = node_at(boundary, CORNER)
    good = paths("good", [0, 0.1], [[0, 0, 0], [0.01, 0, 0]])

    def fails(*words, **settings):
        dynamics = SolveDynamics(**({"Input": boundary, "EndTime": 0.1, "ActiveNodes": [node],
                                     "ToolPaths": good} | settings))
        expect_error(lambda: fetch(dynamics), *words)
        assert servermanager.Fetch(dynamics).GetNumberOfCells() == 0
        dynamics.UpdatePropertyInformation()
        assert dynamics.GetPropertyValue("ErrorCode") != 0

    fails("no density", "Density", Input=scene("without density", quadratic=False))
    fails("columns for 0", "active nodes are 1", "Tool0_X", ToolPaths=None)
    fails("columns for 1", "active nodes are 0", ActiveNodes=[])
    fails("columns for 1", "active nodes are 1", "a rigid tool", Tool="Sphere")
    fails("does not exist", ActiveNodes=[10**6])
    two = paths("two tools", [0, 1], [[0, 0, 0]] * 2, [[0, 0, 0]] * 2)
    fails("columns for 2", "active nodes are 1", ToolPaths=two)
    fails("fixed", TipRadius=1)
    fails("EndTime", "-1", EndTime=-1)
    fails("FrameRate", "0", FrameRate=0)
    fails("a million", FrameRate=1e9)
    fails("ten million", TimeStep=1e-9)
    fails("TimeStep", TimeStep=0)
    fails("SpectralRadius", "2", SpectralRadius=2)
    fails("StepTolerance", "-1", StepTolerance=-1)
    fails("MaximumHalvings", "31", MaximumHalvings=31)
    fails("BodyForce", BodyForce=[0, 0, math.nan])
    fails("tolerance", Tolerance=0)
    fails("radius", ActiveNodes=[], Tool="Sphere", ToolRadius=0)

    def table_fails(text, *words):
        with open("bad.csv", "w") as file:
            file.write(text)
        fails(*words, ToolPaths=CSVReader(FileName=["bad.csv"]))

    table_fails("time,Tool0_X,Tool0_Y,Tool0_Z\n0,0,0,0\n", "no column Time", "it has: time")
    table_fails("Time,Tool0_X,Tool0_Y\n0,0,0\n", "no column Tool0_Z")
    table_fails("Time,Tool0_X,Tool0_Y,Tool0_Z\n0,0,0,a\n", "Tool0_Z", "text")
    table_fails("Time,Tool0_X,Tool0_Y,Tool0_Z\n0,0,0,0\n0,0,0,0.1\n", "Row 1", "Sort")
    table_fails("Time,Tool0_X,Tool0_Y,Tool0_Z\n0,0,0,0\n1,nan,0,0.1\n", "Row 1", "no number")


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(name, "passed", flush=True)
