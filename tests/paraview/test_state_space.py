# SPDX-License-Identifier: BSD-3-Clause
"""PrecomputeStateSpace, StateSpaceReader and TouchStateSpace on a small body of the test's own."""

import os
import sqlite3

import numpy
from paraview import servermanager
from paraview.simple import (AppendDatasets, AssignMaterial, Calculator, EstimateError,
                             OpenDataFile, PrecomputeStateSpace, RedistributeDataSet, SaveData,
                             SolveEquilibrium, StateSpaceReader,
                             TouchStateSpace, Transform)
from state_space_support import arrays_of, expect_same_space, fetch_space, precompute
from support import (Messages, box_body, expect_error, expect_silence, fetch, field, node_at,
                     places, point_array, scene, source)

CORNER, EDGE = [0.2, 0.1, 0.1], [0.1, 0, 0.1]
NOWHERE, INSIDE, EXTRAPOLATED, MARKED = range(4)


def test_every_property():
    space = PrecomputeStateSpace(Input=scene("every"), ActiveNodes=[1, 2], TipRadius=0.01,
                                 HalfWidth=0.02, Resolution=5, ForceLimit=3, Tolerance=0.1,
                                 ToleranceType="Absolute", History="Flat", LogInterval=3,
                                 SinglePrecisionFactors=0,
                                 IntermediateStates=2, ThirdDerivatives=0,
                                 FileName="every.palpate", SolverTolerance=1e-9,
                                 MaximumSeconds=60, RanksPerSolve=2, UpdateInterval=4,
                                 DisplacementBound=1e-2)
    assert list(space.ActiveNodes) == [1, 2] and space.TipRadius == 0.01
    assert (space.HalfWidth, space.Resolution, space.ForceLimit) == (0.02, 5, 3)
    assert space.FileName == "every.palpate"
    assert (space.SolverTolerance, space.DisplacementBound) == (1e-9, 1e-2)
    assert space.RanksPerSolve == 2
    assert space.MaximumSeconds == 60 and space.SinglePrecisionFactors == 0
    assert space.LogInterval == 3 and space.UpdateInterval == 4
    assert space.IntermediateStates == 2 and space.ThirdDerivatives == 0
    for history in ("Flat", "Automatic", "Levels"):
        space.History = history
        assert space.History == history
    assert (space.Tolerance, space.ToleranceType) == (0.1, "Absolute")
    reader = StateSpaceReader(FileName="every.palpate", DisplacementBound=1e-2)
    assert reader.DisplacementBound == 1e-2
    touch = TouchStateSpace(Input=reader, ActiveNode=2, Displacement=[1, 2, 3])
    for method in ("Trilinear", "Tricubic", "RBF linear", "RBF cubic", "Energy Hermite", "Linear"):
        touch.Interpolation = method
        assert touch.Interpolation == method
    assert list(touch.Displacement) == [1, 2, 3] and touch.ActiveNode == 2
    touch.Stress, touch.WholeBody = 1, 1
    assert touch.Stress == touch.WholeBody == 1


def test_contents():
    boundary = scene("contents")
    nodes = [node_at(boundary, CORNER), node_at(boundary, EDGE)]
    blocks = fetch_space(precompute(boundary, nodes))
    body, surface, space = (blocks[name] for name in ("Body", "Surface", "Configurations"))
    assert (places(body) == places(fetch(boundary))).all()
    assert {"Fixed", "Touchable"} <= arrays_of(body.GetPointData()).keys()

    assert space.GetNumberOfPoints() == space.GetNumberOfVerts() == 2 * 5 ** 3
    assert space.GetNumberOfLines() == 2 * (5 ** 3 - 1)
    arrays = arrays_of(space.GetPointData())
    components = {name: 1 if array.ndim == 1 else array.shape[1] for name, array in arrays.items()}
    modes = components["Coefficients"]
    assert components == {
        "ActiveNode": 1, "CheckPoint": 3, "ParentCheckPoint": 3, "Level": 1, "ParentLevel": 1,
        "Displacement": 3, "Force": 3, "Energy": 1, "Stiffness": 9, "ThirdDerivative": 10,
        "Coefficients": modes,
        "CoefficientGradient": 3 * modes, "Outcome": 1, "Flags": 1, "SolveStatus": 1, "Residual": 1,
        "MinimumDetF": 1, "NegativePivots": 1, "Iterations": 1, "Seconds": 1}
    # Each active node has modes of its own; the largest number of them is that of the coefficients.
    own = {node: arrays_of(surface.GetPointData())[f"Modes {node}"] for node in nodes}
    assert max(array.shape[1] for array in own.values()) == 3 * modes
    assert (arrays["Outcome"] == 0).all()
    # A vertex is where the active node is displaced to.
    at_rest = places(body)[arrays["ActiveNode"].astype(int)]
    assert numpy.allclose(places(space), at_rest + arrays["Displacement"], rtol=0, atol=1e-15)
    assert numpy.allclose(arrays["Displacement"], 0.01 * arrays["CheckPoint"], rtol=1e-14)
    # The rest position is a check-point, without force.
    rest = (arrays["CheckPoint"] == 0).all(axis=1)
    assert rest.sum() == 2 and (arrays["Force"][rest] == 0).all()
    # The modes give the displacement of the active nodes back, to their bound.
    of_node = {int(m): i for i, m in enumerate(arrays_of(surface.GetPointData())["MeshPoint"])}
    for q, node in enumerate(arrays["ActiveNode"].astype(int)):
        of_point = own[node][of_node[node]].reshape(-1, 3)
        found = arrays["Coefficients"][q, :len(of_point)] @ of_point
        error = numpy.linalg.norm(found - arrays["Displacement"][q])
        assert error <= 1.01e-3 * field(space, "LargestDisplacement")[0]
    assert field(space, "Solved")[0] == 250 and field(space, "Complete")[0] == 1
    assert 0 < field(space, "FloorSeconds")[0] < field(space, "ExplorationSeconds")[0]


def test_size():
    """Bytes a configuration by the number of modes, and the bound, at every point of the surface
    and every configuration, against the displacement in the file."""
    boundary = scene("size")
    node = node_at(boundary, CORNER)
    precompute(boundary, [node], FileName="size.palpate").UpdatePipeline()
    database = sqlite3.connect("file:size.palpate?mode=ro", uri=True)
    numbers_of_modes = []
    for bound in (1e-2, 1e-3, 1e-4):
        reader = StateSpaceReader(FileName="size.palpate", DisplacementBound=bound)
        blocks = fetch_space(reader)
        surface, space = blocks["Surface"], blocks["Configurations"]
        count = space.GetNumberOfPoints()
        assert count == 5 ** 3
        coefficients, gradients = (point_array(space, name)
                                   for name in ("Coefficients", "CoefficientGradient"))
        modes = coefficients.shape[1]
        numbers_of_modes.append(modes)
        attributes = space.GetPointData()
        arrays = [attributes.GetAbstractArray(i) for i in range(attributes.GetNumberOfArrays())]
        arrays.append(space.GetPoints().GetData())
        for cells in (space.GetVerts(), space.GetLines()):
            arrays += [cells.GetConnectivityArray(), cells.GetOffsetsArray()]
        size = sum(array.GetNumberOfValues() * array.GetDataTypeSize() for array in arrays) / count
        # 353 for the figures, 80 of them the third derivatives, and of each mode a coefficient and
        # its gradient in single precision; the end of the offsets of both kinds of cells is shared
        # by all.
        assert size <= 353 + 16 * modes + 16 / count, (size, modes)
        assert coefficients.dtype == gradients.dtype == numpy.float32

        basis = point_array(surface, "Modes").reshape(surface.GetNumberOfPoints(), modes, 3)
        mesh_points = point_array(surface, "MeshPoint")
        largest = error = 0.0
        for c, check_point in enumerate(point_array(space, "CheckPoint")):
            (blob,), = database.execute("SELECT u FROM configuration WHERE i = ? AND j = ? "
                                        "AND k = ?", [int(x) for x in check_point])
            u = numpy.frombuffer(blob).reshape(-1, 3)[mesh_points]
            of_modes = numpy.einsum("pmc,m->pc", basis, coefficients[c])
            largest = max(largest, numpy.linalg.norm(u, axis=1).max())
            error = max(error, numpy.linalg.norm(u - of_modes, axis=1).max())
        assert numpy.isclose(field(space, "LargestDisplacement")[0], largest, rtol=1e-6)
        assert error <= field(space, "DisplacementError")[0] <= bound * largest * (1 + 1e-6)
        # What is told is not far from what is: the bound is used.
        assert error > 0.1 * bound * largest, (error / largest, bound)
    assert numbers_of_modes[0] < numbers_of_modes[1] < numbers_of_modes[2] <= 106, numbers_of_modes
    database.close()


def test_touch_against_exact_solves():
    boundary = scene("exact", quadratic=False)
    node = node_at(boundary, CORNER)
    space = precompute(boundary, [node])
    touch = TouchStateSpace(Input=space, ActiveNode=node)
    exact = SolveEquilibrium(Input=boundary, ActiveNodes=[node])
    rest = fetch_space(space)["Surface"]
    mesh_points = point_array(rest, "MeshPoint")
    errors = {"Trilinear": [], "Energy Hermite": []}
    field_errors = []
    for t in numpy.random.default_rng(5).uniform(-0.02, 0.02, (12, 3)):
        exact.Displacement = touch.Displacement = list(t)
        solution = fetch(exact)
        force = field(solution, "ReactionForce")[0]
        for method, errors_of_method in errors.items():
            touch.Interpolation = method
            result = fetch(touch)
            assert field(result, "Found")[0] == INSIDE
            error = numpy.linalg.norm(field(result, "Force")[0] - force)
            errors_of_method.append(error / numpy.linalg.norm(force))
        u = point_array(result, "Displacement")
        assert numpy.allclose(places(result), places(rest) + u, rtol=0, atol=1e-7)
        field_errors.append(
            numpy.abs(u - point_array(solution, "Displacement")[mesh_points]).max())
    print(f"mean relative force error: {numpy.mean(errors['Trilinear']):.1e} trilinear, "
          f"{numpy.mean(errors['Energy Hermite']):.1e} energy Hermite; "
          f"largest error of the surface {max(field_errors):.1e} m")
    # Orders of magnitude, so that a wrong interpolation is noticed.
    assert numpy.mean(errors["Trilinear"]) < 0.1
    assert numpy.mean(errors["Energy Hermite"]) < 0.1 * numpy.mean(errors["Trilinear"])
    assert max(field_errors) < 0.01 * 0.035


def test_tip():
    """What a tip touches: the file, its reader and the stock writer know the radius."""
    boundary = scene("tip")
    node = node_at(boundary, CORNER)
    settings = {"TipRadius": 0.03, "Resolution": 3, "HalfWidth": 0.01}
    space = precompute(boundary, [node], FileName="tip.palpate", **settings)
    blocks = fetch_space(space)
    arrays = arrays_of(blocks["Configurations"].GetPointData())
    assert field(blocks["Configurations"], "TipRadius")[0] == 0.03
    for i in (0, 9, 26):
        exact = fetch(SolveEquilibrium(Input=boundary, ActiveNodes=[node], TipRadius=0.03,
                                       Displacement=list(arrays["Displacement"][i])))
        assert numpy.allclose(field(exact, "ReactionForce")[0], arrays["Force"][i], rtol=1e-6)
    reader = StateSpaceReader(FileName="tip.palpate")
    SaveData("tip.vtpc", proxy=space, DataMode="Binary")
    for other in (reader, OpenDataFile(os.path.abspath("tip.vtpc"))):
        assert field(fetch_space(other)["Configurations"], "TipRadius")[0] == 0.03
        touch = TouchStateSpace(Input=other, Displacement=list(arrays["Displacement"][9]))
        assert numpy.allclose(field(fetch(touch), "Force")[0], arrays["Force"][9], rtol=1e-9)
    # Another radius is another tool.
    space.TipRadius = 0
    expect_error(space.UpdatePipeline, "tip.palpate", "tip radius 0.03", "tip radius 0 ")
    space.FileName = ""
    assert field(fetch_space(space)["Configurations"], "TipRadius")[0] == 0
    stiffer = arrays["Energy"] > arrays_of(
        fetch_space(space)["Configurations"].GetPointData())["Energy"]
    assert stiffer.sum() == 26
    expect_error(lambda: precompute(boundary, [node], TipRadius=0.3).UpdatePipeline(), "fixed",
                 str(node))


def test_touch_is_exact_at_check_points_and_goes_on_outside():
    boundary = scene("points", quadratic=False)
    node = node_at(boundary, CORNER)
    space = precompute(boundary, [node])
    arrays = arrays_of(fetch_space(space)["Configurations"].GetPointData())
    touch = TouchStateSpace(Input=space)
    for i in range(0, len(arrays["Energy"]), 17):
        touch.Displacement = list(arrays["Displacement"][i])
        result = fetch(touch)
        assert numpy.allclose(field(result, "Force")[0], arrays["Force"][i], rtol=1e-9, atol=1e-12)
        assert numpy.isclose(field(result, "Energy")[0], arrays["Energy"][i], rtol=1e-9)
        assert field(result, "ActiveNode")[0] == node
    touch.Displacement = [0.05, 0, 0]
    assert field(fetch(touch), "Found")[0] == EXTRAPOLATED
    assert numpy.isfinite(field(fetch(touch), "Force")).all()
    touch.Displacement = [1e200, 0, 0]
    assert numpy.isfinite(places(fetch(touch))).all()


def test_forms_of_a_space():
    """A file, its reader and the stock writer and reader give what the memory holds."""
    boundary = scene("forms", quadratic=False)
    nodes = [node_at(boundary, CORNER), node_at(boundary, EDGE)]
    in_memory = fetch_space(precompute(boundary, nodes))
    kept = precompute(boundary, nodes, FileName="forms.palpate")
    in_file = fetch_space(kept)
    expect_same_space(in_memory, in_file)
    assert not [name for name in os.listdir(".") if name.startswith("forms.palpate.")]

    reader = StateSpaceReader(FileName="forms.palpate")
    expect_same_space(in_file, fetch_space(reader))
    read = fetch_space(reader)["Configurations"].GetFieldData()
    assert read.GetAbstractArray("FileName").GetValue(0) == "forms.palpate"
    assert read.GetArray("Complete").GetValue(0) == 1
    opened = OpenDataFile(os.path.abspath("forms.palpate"))
    expect_same_space(in_file, fetch_space(opened))

    SaveData("forms.vtpc", proxy=kept, DataMode="Binary")
    stock = OpenDataFile(os.path.abspath("forms.vtpc"))
    expect_same_space(in_file, fetch_space(stock))
    forces = []
    for space in (kept, reader, stock):
        touch = TouchStateSpace(Input=space, ActiveNode=nodes[1],
                                Displacement=[0.003, 0.002, -0.004])
        result = fetch(touch)
        assert field(result, "Found")[0] == INSIDE
        forces.append(field(result, "Force")[0])
    assert (forces[0] == forces[1]).all() and (forces[0] == forces[2]).all()

    # A program without VTK reads it too.
    file = sqlite3.connect("forms.palpate")
    rest = numpy.frombuffer(file.execute("SELECT points FROM scene").fetchone()[0]).reshape(-1, 3)
    assert (rest == places(in_file["Body"])).all()
    assert file.execute("SELECT count(*) FROM configuration").fetchone() == (250,)


def test_resume():
    boundary = scene("resume", quadratic=False)
    nodes = [node_at(boundary, CORNER), node_at(boundary, EDGE)]
    first = precompute(boundary, nodes[:1], FileName="resume.palpate")
    assert field(fetch_space(first)["Configurations"], "Solved")[0] == 125
    both = fetch_space(precompute(boundary, nodes, FileName="resume.palpate"))["Configurations"]
    assert field(both, "Solved")[0] == field(both, "Reused")[0] == 125
    # The body of a space is a scene: the same one.
    reader = StateSpaceReader(FileName="resume.palpate")
    from paraview.simple import ExtractBlock, MergeBlocks
    body = MergeBlocks(Input=ExtractBlock(Input=reader, Selectors=["/Root/Body"]))
    again = fetch_space(precompute(body, nodes, FileName="resume.palpate"))["Configurations"]
    assert field(again, "Solved")[0] == 0


def test_a_damaged_row_is_left_out():
    boundary = scene("damaged", quadratic=False)
    node = node_at(boundary, CORNER)
    settings = {"Resolution": 3, "FileName": "damaged.palpate"}
    precompute(boundary, [node], **settings).UpdatePipeline()
    file = sqlite3.connect("damaged.palpate")
    with file:
        file.execute("UPDATE configuration SET energy = energy + 1 WHERE (i, j, k) = (1, 0, 0)")
    file.close()
    what = f"configuration (1, 0, 0) of active node {node}"
    reader = StateSpaceReader(FileName="damaged.palpate")
    with Messages() as messages:
        space = fetch_space(reader)["Configurations"]
    assert (messages.errors, messages.warnings) == (0, 1), messages.text
    assert "damaged.palpate" in messages.text and what in messages.text, messages.text
    assert space.GetNumberOfPoints() == 26
    left_out = space.GetFieldData().GetAbstractArray("LeftOut")
    assert [left_out.GetValue(i) for i in range(left_out.GetNumberOfValues())] == [what]
    assert field(space, "Complete")[0] == 0
    # A run that goes on from the file computes it again.
    with Messages():
        again = fetch_space(precompute(boundary, [node], **settings))["Configurations"]
    assert (field(again, "Solved")[0], field(again, "Reused")[0]) == (1, 26)
    whole = expect_silence(lambda: fetch_space(StateSpaceReader(FileName="damaged.palpate")))
    fields = whole["Configurations"].GetFieldData()
    assert fields.GetAbstractArray("LeftOut").GetNumberOfValues() == 0


def test_partitions():
    """A space whose blocks are split into partitions is the same space."""
    boundary = scene("partitions", quadratic=False)
    node = node_at(boundary, CORNER)
    space = precompute(boundary, [node], Resolution=3, IntermediateStates=1)
    split = RedistributeDataSet(Input=space, NumberOfPartitions=3, PreservePartitionsInOutput=1)
    split.UpdatePipeline()
    blocks = servermanager.Fetch(split, 0)
    for block in (1, 2):
        sizes = [blocks.GetPartition(block, p).GetNumberOfPoints()
                 for p in range(blocks.GetNumberOfPartitions(block))
                 if blocks.GetPartition(block, p)]
        assert sum(size > 0 for size in sizes) > 1, (block, sizes)
    whole, parts = (TouchStateSpace(Input=source, Displacement=[0.012, -0.003, 0.007])
                    for source in (space, split))
    for method in ("Energy Hermite", "RBF cubic"):
        whole.Interpolation = parts.Interpolation = method
        ours, theirs = (expect_silence(lambda touch=touch: fetch(touch))
                        for touch in (parts, whole))
        assert (field(ours, "Force") == field(theirs, "Force")).all()
        assert field(ours, "Found")[0] == INSIDE
        assert (places(ours) == places(theirs)).all()
        assert ours.GetNumberOfCells() == theirs.GetNumberOfCells()
    estimated = EstimateError(Input=split)
    estimated.UpdatePipeline()
    blocks = servermanager.Fetch(estimated, 0)
    for p in range(blocks.GetNumberOfPartitions(2)):
        part = blocks.GetPartition(2, p)
        assert not part or part.GetPointData().HasArray("EstimatedError")


def test_growth():
    """With an update interval a space is given as far as it is found, and each execution goes on;
    in the end it is what it is without."""
    boundary = scene("growth", quadratic=False)
    node = node_at(boundary, CORNER)
    settings = {"Resolution": 3, "HalfWidth": 0.01}
    whole = fetch_space(precompute(boundary, [node], **settings))
    expect_error(precompute(boundary, [node], UpdateInterval=1).UpdatePipeline, "FileName")

    # A configuration is found each time, however short it is.
    space = precompute(boundary, [node], UpdateInterval=1e-6, FileName="growth.palpate", **settings)
    touch = TouchStateSpace(Input=space, Displacement=[0.002, 0, 0])
    numbers = []
    for i in range(3 ** 3):
        space.LogInterval = 10 + i  # executes it anew
        part = expect_silence(lambda: fetch_space(space))["Configurations"]
        numbers.append(part.GetNumberOfPoints())
        assert field(fetch(touch), "Found")[0] != NOWHERE
        if field(part, "Complete")[0] == 1:
            break
        assert field(part, "Solved")[0] > 0
    print("growth:", numbers)
    assert numbers == sorted(set(numbers)) and len(numbers) > 3 and numbers[-1] == 3 ** 3
    expect_same_space(fetch_space(space), whole)


def test_additions():
    """Intermediate states and third derivatives: in memory, in the file and read back from it."""
    boundary = scene("additions", quadratic=False)
    node = node_at(boundary, CORNER)
    settings = {"Resolution": 3, "FileName": "additions.palpate"}
    plain = fetch_space(precompute(boundary, [node], Resolution=3, ThirdDerivatives=0))
    kept = precompute(boundary, [node], IntermediateStates=5, **settings)
    blocks = fetch_space(kept)
    space, states = blocks["Configurations"], blocks["IntermediateStates"]
    for name in ("Solved", "IntermediateStatesSolved", "IntermediateStatesFailed"):
        print(f"{name}: {field(space, name)[0]:g}")
    assert field(space, "Solved")[0] == 27
    assert field(space, "IntermediateStatesSolved")[0] == 26 * 5
    assert field(space, "IntermediateStatesFailed")[0] == 0
    assert field(space, "IntermediateStatesSeconds")[0] > 0
    assert states.GetNumberOfPoints() == states.GetNumberOfVerts() == 26 * 5
    arrays = arrays_of(states.GetPointData())
    assert {name: 1 if array.ndim == 1 else array.shape[1] for name, array in arrays.items()} == {
        "ActiveNode": 1, "TargetCheckPoint": 3, "Number": 1, "Displacement": 3, "Force": 3,
        "Energy": 1, "Outcome": 1, "Flags": 1, "Seconds": 1}
    assert (arrays["Outcome"] == 0).all() and (arrays["ActiveNode"] == node).all()
    share = arrays["Number"][:, None] / 6
    assert numpy.allclose(arrays["Displacement"], 0.02 * share * arrays["TargetCheckPoint"])
    at_rest = places(blocks["Body"])[node]
    assert numpy.allclose(places(states), at_rest + arrays["Displacement"], rtol=0, atol=1e-15)
    exact = SolveEquilibrium(Input=boundary, ActiveNodes=[node])
    for i in (0, 61, 129):
        exact.Displacement = list(arrays["Displacement"][i])
        assert numpy.allclose(field(fetch(exact), "ReactionForce")[0], arrays["Force"][i],
                              rtol=1e-6)
    # What is there without them is the same to the bit, and no larger.
    configurations = arrays_of(space.GetPointData())
    third = configurations.pop("ThirdDerivative")
    without = arrays_of(plain["Configurations"].GetPointData())
    assert configurations.keys() == without.keys() and "IntermediateStates" not in plain
    for name in configurations.keys() - {"Seconds"}:
        assert (configurations[name] == without[name]).all(), name

    with sqlite3.connect("file:additions.palpate?mode=ro", uri=True) as database:
        for check_point, t in zip(configurations["CheckPoint"], third):
            (blob,), = database.execute("SELECT third_derivative FROM configuration WHERE i = ? "
                                        "AND j = ? AND k = ?", [int(x) for x in check_point])
            assert (numpy.frombuffer(blob) == t).all()
        assert database.execute("SELECT count(*) FROM intermediate").fetchone() == (26 * 5,)
    # T is the derivative of the stiffness; between neighbours far apart only roughly.
    stiffness = dict(zip(map(tuple, configurations["CheckPoint"]), configurations["Stiffness"]))
    of_rest = dict(zip(map(tuple, configurations["CheckPoint"]), third))[0, 0, 0]
    for axis, component in ((0, 0), (1, 1), (2, 2)):
        step = tuple(int(i == axis) for i in range(3))
        back = tuple(-x for x in step)
        slope = (stiffness[step][0] - stiffness[back][0]) / 0.04
        assert abs(slope - of_rest[component]) < 0.2 * numpy.abs(of_rest).max(), axis

    SaveData("additions.vtpc", proxy=kept, DataMode="Binary")
    for other in (StateSpaceReader(FileName="additions.palpate"),
                  OpenDataFile(os.path.abspath("additions.vtpc"))):
        read = fetch_space(other)
        expect_same_space(blocks, read)
        for name, value in (("IntermediateStates", 5), ("ThirdDerivatives", 1)):
            assert field(read["Configurations"], name)[0] == value
        touch = TouchStateSpace(Input=other, Displacement=[0.003, 0.002, -0.004])
        assert field(fetch(touch), "Found")[0] == INSIDE
    expect_error(precompute(boundary, [node], **settings).UpdatePipeline,
                 "5 intermediate states", "0 intermediate states")
    expect_error(precompute(boundary, [node], IntermediateStates=5, ThirdDerivatives=0,
                            **settings).UpdatePipeline, "no third derivatives")
    expect_error(precompute(boundary, [node], IntermediateStates=-1).UpdatePipeline,
                 "intermediate states")


def check_touched_mesh_error(space, exact, place, corrects):
    """At a place that the space never saw, the error that a touch tells is that of an exact solve,
    and the force is corrected by it where that is sound."""
    expected = field(fetch(exact), "MeshError")[0]
    size = numpy.linalg.norm(expected)
    touch = TouchStateSpace(Input=space, **place)
    corrected = fetch(touch)
    touch.CorrectMeshError = 0
    told = fetch(touch)
    for touched, is_corrected in ((corrected, corrects), (told, False)):
        error = field(touched, "MeshError")[0]
        assert numpy.linalg.norm(error - expected) < 0.05 * size, (error, expected)
        assert field(touched, "MeshErrorReliable")[0] == corrects
        assert field(touched, "MeshErrorCorrected")[0] == is_corrected
        bound = (0.5 if is_corrected else 1.5) * numpy.linalg.norm(error)
        assert abs(field(touched, "MeshErrorBound")[0] - bound) < 1e-12 * bound
    difference = field(told, "Force")[0] - field(corrected, "Force")[0]
    expected = field(told, "MeshError")[0] if corrects else numpy.zeros(3)
    assert numpy.linalg.norm(difference - expected) < 1e-9 * size
    # Other methods tell nothing, and correct nothing.
    touch.CorrectMeshError, touch.Interpolation = 1, "Trilinear"
    assert not fetch(touch).GetFieldData().HasArray("MeshError")


def test_mesh_error_of_a_rigid_tool():
    boundary = scene("rigid_mesh_error")
    ball = {"Tool": "Sphere", "ToolRadius": 0.05}
    space = PrecomputeStateSpace(Input=boundary, Depth=0.016, Spacing=0.008, UseToolRegion=1,
                                 ToolRegion="Sphere", EstimateMeshError=1, LogInterval=0, **ball)
    space.ToolRegion.Center, space.ToolRegion.Radius = [0.1, 0.05, 0.1], 0.012
    place = [0.1013, 0.0488, 0.1391]
    exact = SolveEquilibrium(Input=boundary, EstimateMeshError=1, ToolPosition=place, **ball)
    check_touched_mesh_error(space, exact, {"ToolPosition": place}, True)


def test_mesh_error():
    """The error of the mesh at each configuration: that of Solve Equilibrium, also from a file."""
    boundary = scene("mesh_error")
    node = node_at(boundary, CORNER)
    settings = {"Resolution": 3, "HalfWidth": 0.004, "TipRadius": 0.06}
    plain = arrays_of(fetch_space(precompute(boundary, [node], **settings))
                      ["Configurations"].GetPointData())
    kept = precompute(boundary, [node], EstimateMeshError=1, FileName="mesh_error.palpate",
                      **settings)
    blocks = fetch_space(kept)
    arrays = arrays_of(blocks["Configurations"].GetPointData())
    errors = {name: arrays.pop(name)
              for name in ("MeshError", "MeshErrorEnergy", "MeshErrorReliable")}
    assert arrays.keys() == plain.keys()
    for name in arrays.keys() - {"Seconds"}:
        assert (arrays[name] == plain[name]).all(), name
    assert (errors["MeshErrorEnergy"] <= 0).all()
    # At the rim of a tip that is bonded, stress is singular.
    assert (errors["MeshErrorReliable"] == 0).all()
    exact = SolveEquilibrium(Input=boundary, ActiveNodes=[node], TipRadius=0.06,
                             EstimateMeshError=1)
    for i in (0, 5, 22):
        exact.Displacement = list(arrays["Displacement"][i])
        expected = field(fetch(exact), "MeshError")[0]
        size = numpy.linalg.norm(expected)
        assert size > 0.01 * numpy.linalg.norm(arrays["Force"][i])
        # Sensitivities of configurations from which none is reached are less exact.
        assert numpy.linalg.norm(errors["MeshError"][i] - expected) < 1e-3 * size
    place = [0.0011, -0.0023, 0.0031]
    exact.Displacement = place
    check_touched_mesh_error(kept, exact, {"Displacement": place}, False)
    SaveData("mesh_error.vtpc", proxy=kept, DataMode="Binary")
    for other in (StateSpaceReader(FileName="mesh_error.palpate"),
                  OpenDataFile(os.path.abspath("mesh_error.vtpc"))):
        expect_same_space(blocks, fetch_space(other))
    # What a file has without it stays without it.
    precompute(boundary, [node], FileName="later.palpate", **settings).UpdatePipeline()
    later = precompute(boundary, [node], FileName="later.palpate", EstimateMeshError=1, **settings)
    expect_silence(later.UpdatePipeline)
    assert "MeshError" not in arrays_of(fetch_space(later)["Configurations"].GetPointData())


def test_tolerance():
    boundary = scene("tolerance", quadratic=False)
    node = node_at(boundary, CORNER)
    settings = {"HalfWidth": 0.06, "FileName": "tolerance.palpate"}
    loose = fetch_space(precompute(boundary, [node], Tolerance=0.05, **settings))["Configurations"]
    solved = field(loose, "Solved")[0]
    space = precompute(boundary, [node], Tolerance=5e-5, **settings)
    configurations = fetch_space(space)["Configurations"]
    assert field(configurations, "Reused")[0] == solved >= 125
    assert field(configurations, "Solved")[0] > 0
    for name, value in (("Tolerance", 5e-5), ("ToleranceIsRelative", 1), ("CoarsestCell", 64)):
        assert field(configurations, name)[0] == value, name
    largest = numpy.linalg.norm(point_array(configurations, "Force"), axis=1).max()
    SaveData("tolerance.vtpc", proxy=space, DataMode="Binary")
    touch = TouchStateSpace(Input=space, ActiveNode=node)
    saved = TouchStateSpace(Input=OpenDataFile(os.path.abspath("tolerance.vtpc")), ActiveNode=node)
    exact = SolveEquilibrium(Input=boundary, ActiveNodes=[node])
    compared = 0
    for t in numpy.random.default_rng(8).uniform(-0.06, 0.06, (20, 3)):
        exact.Displacement = touch.Displacement = saved.Displacement = list(t)
        solution, touched = fetch(exact), fetch(touch)
        force = field(touched, "Force")[0]
        assert (field(fetch(saved), "Force")[0] == force).all()
        if field(touched, "Found")[0] != INSIDE or field(solution, "Flags")[0] != 0:
            continue
        compared += 1
        error = numpy.linalg.norm(force - field(solution, "ReactionForce")[0])
        assert error <= 5e-5 * largest, (t, error / largest)
    assert compared > 5
    # In N the same tolerance is the same space.
    other = fetch_space(precompute(boundary, [node], HalfWidth=0.06, ToleranceType="Absolute",
                                   Tolerance=0.05 * largest))["Configurations"]
    assert field(other, "Solved")[0] >= 125
    expect_error(lambda: precompute(boundary, [node], Tolerance=-1).UpdatePipeline(), "tolerance")


def test_the_same_body_again_is_not_solved_again():
    boundary = scene("again", quadratic=False)
    space = precompute(boundary, [node_at(boundary, CORNER)], Resolution=3)

    def seconds():
        return field(fetch_space(space)["Configurations"], "ExplorationSeconds")[0]

    first = seconds()
    boundary.FixedRegion.Normal = [2, 0, 0]  # the same plane
    assert seconds() == first
    space.HalfWidth = 0.01
    second = seconds()
    assert second != first
    boundary.FixedRegion.Origin = [0.01, 0, 0]
    boundary.FixedRegion.Normal = [1, 0, 0.1]
    space.HalfWidth = 0.02
    assert seconds() != second


def test_many_materials():
    """A stock Calculator makes the stiffness vary from cell to cell."""
    boundary = scene("graded")
    graded = Calculator(Input=boundary, AttributeType="Cell Data", ResultArrayName="YoungsModulus",
                        Function="YoungsModulus*(1+Law)")
    node = node_at(boundary, CORNER)
    ours, theirs = (fetch_space(precompute(s, [node], Resolution=3))["Configurations"]
                    for s in (boundary, graded))
    ratio = point_array(theirs, "Energy") / numpy.maximum(point_array(ours, "Energy"), 1e-30)
    # Law is 2: three times as stiff everywhere, and so is the energy.
    assert numpy.allclose(ratio[point_array(ours, "Energy") > 0], 3, rtol=1e-8)


def test_bad_input():
    boundary = scene("bad")
    node = node_at(boundary, CORNER)

    def run(**settings):
        return lambda: precompute(boundary, [node], **settings).UpdatePipeline()

    expect_error(run(Resolution=4), "resolution", "odd")
    expect_error(run(Resolution=131), "resolution", "129")
    expect_error(run(RanksPerSolve=2), "ranks per solve", "the number of ranks, 1")
    expect_error(run(RanksPerSolve=0), "ranks per solve")
    expect_error(run(HalfWidth=0), "half-width")
    expect_error(run(DisplacementBound=1), "displacement bound")
    expect_error(run(ForceLimit=-1), "force limit")
    expect_error(run(FileName="no/such/folder/a.palpate"), "no/such/folder")
    expect_error(lambda: precompute(boundary, [node_at(boundary, [0, 0, 0])]).UpdatePipeline(),
                 "fixed")
    expect_error(lambda: precompute(boundary, [node_at(boundary, [0.1, 0.05, 0.05])])
                 .UpdatePipeline(), "inside")
    expect_error(lambda: precompute(boundary, [100000]).UpdatePipeline(), "100000", "not exist")

    good = precompute(boundary, [node], Resolution=3, FileName="bad.palpate")
    good.UpdatePipeline()
    other = scene("bad-other", "St. Venant-Kirchhoff")
    expect_error(lambda: precompute(other, [node], Resolution=3, FileName="bad.palpate")
                 .UpdatePipeline(), "bad.palpate", "another scene")
    expect_error(lambda: precompute(boundary, [node], Resolution=5, FileName="bad.palpate")
                 .UpdatePipeline(), "bad.palpate")
    expect_error(lambda: TouchStateSpace(Input=good, ActiveNode=3).UpdatePipeline(), "3",
                 str(node))
    expect_error(lambda: StateSpaceReader(FileName="missing.palpate").UpdatePipeline(),
                 "missing.palpate")
    with open("text.palpate", "w", encoding="utf-8") as text:
        text.write("This is no state space." * 100)
    expect_error(lambda: StateSpaceReader(FileName="text.palpate").UpdatePipeline(), "text.palpate")
    expect_error(lambda: precompute(boundary, [node], FileName="text.palpate").UpdatePipeline(),
                 "text.palpate")
    with open("bad.palpate", "rb") as whole, open("cut.palpate", "wb") as part:
        part.write(whole.read()[:30000])
    expect_error(lambda: StateSpaceReader(FileName="cut.palpate").UpdatePipeline(), "cut.palpate")
    # A piece that nothing holds, in a body that is held.
    pieces = AppendDatasets(Input=[source(box_body(), "held"), Transform(
        Input=source(box_body(), "floating"))])
    pieces.Input[1].Transform.Translate = [1, 0, 0]
    held = Calculator(Input=AssignMaterial(Input=pieces), ResultArrayName="Fixed",
                      Function="coordsX<0.001")
    expect_error(lambda: precompute(held, [node], FileName="pieces.palpate").UpdatePipeline(),
                 "not held")
    # One cause, one message, also through several filters.
    broken = precompute(boundary, [node], Resolution=4)
    expect_error(lambda: TouchStateSpace(Input=broken).UpdatePipeline(), "resolution")
    # And all is well afterwards.
    expect_silence(lambda: fetch(TouchStateSpace(Input=good)))


def test_failed_configurations_are_marked():
    """A push that inverts cells of St. Venant-Kirchhoff converges, and is marked."""
    boundary = scene("inverted", "St. Venant-Kirchhoff")
    node = node_at(boundary, CORNER)
    space = precompute(boundary, [node], HalfWidth=0.06, Resolution=3)
    with Messages():
        arrays = arrays_of(fetch_space(space)["Configurations"].GetPointData())
    inverted = (arrays["Flags"] & 1) != 0
    assert inverted.any() and not inverted.all()
    assert (inverted == (arrays["MinimumDetF"] <= 0)).all()
    touch = TouchStateSpace(Input=space)
    worst = arrays["Displacement"][arrays["MinimumDetF"].argmin()]
    touch.Displacement = list(0.5 * worst)
    assert field(fetch(touch), "Found")[0] == MARKED


for name, test in list(globals().items()):
    if name.startswith("test_"):
        print(name)
        test()
