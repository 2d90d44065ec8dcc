# SPDX-License-Identifier: BSD-3-Clause
"""Cuts in a body: Place Cut, and the stages that follow from it."""

import numpy
from paraview.simple import (AssignMaterial, Calculator, CarrySurface, CutNow, CutPlane,
                             ExtractSurface, OutputPort, PassThrough, PlaceCut, Plane,
                             PrecomputeStateSpace, SetBoundary, SolveEquilibrium, StateSpaceReader,
                             TouchStateSpace)
from support import (box_body, cell_array, expect_error, expect_silence, fetch, field, node_at,
                     places, point_array, source)

LENGTHS = (0.1, 0.06, 0.06)
HEIGHT = 0.031
DEPTH = 0.04


def sheet(depth=DEPTH, height=HEIGHT):
    """A plane that comes from x < 0 and is wider than the body."""
    return Plane(Origin=[-0.02, -0.02, height], Point1=[depth, -0.02, height],
                 Point2=[-0.02, 0.08, height], XResolution=20, YResolution=20)


def body(name, quadratic=True):
    return source(box_body((6, 4, 4), LENGTHS, quadratic), name)


def test_stages():
    cut = PlaceCut(Input=body("stages"), Sheet=sheet(), CutDirection=[1, 0, 0], StageSpacing=0.01)
    expect_silence(cut.UpdatePipeline)
    closed = fetch(cut)
    area = field(closed, "StageArea").ravel()
    assert numpy.allclose(area, 0.01 * LENGTHS[1] * numpy.arange(5), rtol=1e-9), area
    assert numpy.allclose(field(closed, "StageFront").ravel(), 0.01 * numpy.arange(5)), closed
    for stage in range(5):
        cut.Stage = stage
        grid = fetch(cut)
        assert grid.GetNumberOfCells() == closed.GetNumberOfCells()
        assert (cell_array(grid, "CutStage") == cell_array(closed, "CutStage")).all()
        here = places(grid)
        on = (abs(here[:, 2] - HEIGHT) < 1e-9) & (here[:, 0] < 0.01 * stage - 1e-9)
        # Of those behind the front there are two.
        assert len(here) - closed.GetNumberOfPoints() == on.sum() / 2, stage
    cut.Stage = 5
    expect_error(cut.UpdatePipeline, "Stage is 5", "4 stages")


def test_arrays():
    marked = Calculator(Input=body("arrays"), ResultArrayName="Sum", Function="coordsX+2*coordsZ")
    cut = PlaceCut(Input=marked, Sheet=sheet(), CutDirection=[1, 0, 0], Stage=2)
    grid = fetch(cut)
    here = places(grid)
    found = point_array(grid, "Sum")
    assert numpy.allclose(found, here[:, 0] + 2 * here[:, 2], atol=1e-9), found
    faces = fetch(PassThrough(Input=OutputPort(cut, 1)))
    assert set(cell_array(faces, "CutStage")) == set(range(1, 9)), faces


def test_opened():
    """A cut makes the body softer from stage to stage."""
    forces = []
    for stage in (0, 2, 4):
        boundary = boundary_at(f"opened{stage}", stage)
        tip = {"ActiveNodes": [node_at(boundary, [0, 0.03, LENGTHS[2]])], "TipRadius": 0.012}
        solved = fetch(SolveEquilibrium(Input=boundary, Displacement=[0, 0, 0.004], **tip))
        assert field(solved, "Outcome")[0] == 0
        forces.append(field(solved, "ReactionForce")[0][2])
    assert forces[0] > 1.1 * forces[1] > 1.1**2 * forces[2] > 0, forces


def boundary_at(name, stage, spacing=0.01, **contact):
    """The body with its cut open up to a stage, held at its bottom."""
    cut = PlaceCut(Input=body(name), Sheet=sheet(), CutDirection=[1, 0, 0], StageSpacing=spacing,
                   Stage=stage)
    return hold(cut, **contact)


def hold(grid, **contact):
    """The body with a tissue, held at its bottom."""
    boundary = SetBoundary(Input=AssignMaterial(Input=grid, Law="Neo-Hookean"),
                           FixedRegion="Plane", **contact)
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 1e-6], [0, 0, 1]
    return boundary


def pressed(boundary):
    """The force that presses the top down above the cut."""
    node = node_at(boundary, [LENGTHS[0] / 3, 0.03, LENGTHS[2]])
    solved = fetch(SolveEquilibrium(Input=boundary, Displacement=[0, 0, -0.003],
                                    ActiveNodes=[node], TipRadius=0.012))
    assert field(solved, "Outcome")[0] == 0
    layer = field(solved, "PartLayerForce")[0][2] if boundary.Input.Input.Stage else 0
    return field(solved, "ReactionForce")[0][2], layer


def test_lips():
    """A closed cut that is pressed is about as stiff as the body without it."""
    whole, _ = pressed(boundary_at("whole", 0))
    usual, layer = pressed(boundary_at("usual", 4))
    thin, thin_layer = pressed(boundary_at("thin", 4, Contact="Between Sides Of A Cut",
                                           ContactThickness=1e-4))
    assert whole < thin < usual < 0.94 * whole < 0, (whole, thin, usual)
    # A part of it is the layer that is told; the rest is true slip.
    assert usual - layer < 0.96 * whole, (whole, usual, layer)
    assert layer > 2 * thin_layer > 0, (layer, thin_layer)


TIP = [0, 0.03, LENGTHS[2]]
PULL = [0, 0, 0.006]


def two_stages(name, stage=0):
    return boundary_at(name, stage, spacing=0.02)


def space_of_stages(boundary, **properties):
    return PrecomputeStateSpace(Input=boundary, ActiveNodes=[node_at(boundary, TIP)],
                                TipRadius=0.012, HalfWidth=0.006, Resolution=3, LogInterval=0,
                                **properties)


def openings(grid, rest):
    """How far apart the two points of each place of the cut at the edge x = 0 are."""
    moved = point_array(grid, "Displacement")
    on = [p for p in range(len(rest)) if abs(rest[p][2] - HEIGHT) < 1e-7 and rest[p][0] < 1e-7]
    twins = {}
    for p in on:
        twins.setdefault(round(float(rest[p][1]), 4), []).append(moved[p])
    return {y: abs(two[0] - two[1]).max() for y, two in twins.items() if len(two) == 2}


def test_space_of_stages():
    """A space of all stages has the forces, energies and shapes of solves at each of them."""
    boundary = two_stages("stages_of_space")
    areas = field(fetch(boundary), "StageArea").ravel()
    space = space_of_stages(boundary, FileName="stages.palpate")
    expect_silence(space.UpdatePipeline)
    touch = TouchStateSpace(Input=space, ActiveNode=node_at(boundary, TIP), Displacement=PULL)
    energies = []
    for stage, area in enumerate(areas):
        opened = two_stages(f"stage{stage}_of_space", stage)
        solved = fetch(SolveEquilibrium(Input=opened, ActiveNodes=[node_at(opened, TIP)],
                                        TipRadius=0.012, Displacement=PULL))
        touch.TornArea = area
        found = fetch(touch)
        assert numpy.isclose(field(found, "TornArea")[0], area)
        assert numpy.allclose(field(found, "Force"), field(solved, "ReactionForce"), rtol=1e-6,
                              atol=1e-7), stage
        energies.append(field(solved, "Energy")[0])
        assert numpy.isclose(field(found, "Energy")[0], energies[-1], rtol=1e-6), stage
        right = openings(solved, places(solved))
        assert (len(right) > 0) == (stage > 0)
        for y, opening in openings(
                found, places(found) - point_array(found, "Displacement")).items():
            assert abs(opening - right.get(y, 0)) < 2e-5, (stage, y, opening, right)
    check_display_surface(touch, solved, areas)
    check_tear(touch, areas, numpy.array(energies))
    # A run that goes on from the file finds nothing to do.
    again = space_of_stages(boundary, FileName="stages.palpate")
    again.UpdatePipeline()
    assert again.FieldData["Solved"].GetRange(0)[0] == 0
    reader = StateSpaceReader(FileName="stages.palpate")
    read = TouchStateSpace(Input=reader, ActiveNode=node_at(boundary, TIP), Displacement=PULL,
                           TornArea=0.7 * areas[1])
    touch.FractureToughness = 0
    touch.TornArea = 0.7 * areas[1]
    for name in "Force", "Energy", "TornArea", "ReleaseRate":
        assert numpy.array_equal(field(fetch(read), name), field(fetch(touch), name)), name


def check_display_surface(touch, solved, areas):
    """A finer surface opens as the body does, and has its arrays and the sides of the cut."""
    fine = ExtractSurface(Input=source(box_body((23, 13, 14), LENGTHS, False), "fine"))
    fine = Calculator(Input=fine, ResultArrayName="Height", Function="coordsZ")
    expected = openings(solved, places(solved))
    for shown in (CarrySurface(Input=source(solved, "solved"), Surface=fine),
                  TouchStateSpace(Input=touch.Input, ActiveNode=touch.ActiveNode,
                                  Displacement=PULL, TornArea=areas[-1], DisplaySurface=fine)):
        grid = fetch(shown)
        u = point_array(grid, "Displacement")
        rest = places(grid) - u
        outside = abs(rest[:, 2] - HEIGHT) > 1e-6
        assert numpy.allclose(point_array(grid, "Height")[outside], rest[outside, 2], atol=1e-6)
        found = openings(grid, rest)
        right = numpy.interp(list(found), sorted(expected), [expected[y] for y in sorted(expected)])
        assert len(found) > 10 and right.max() > 1e-3
        assert abs(numpy.array(list(found.values())) - right).max() < 0.05 * right.max(), (
            found, right)
        # Both sides of the cut, and what is around it.
        sides = abs(rest[:, 2] - HEIGHT) < 1e-6
        assert (sides & (rest[:, 0] > 0.005) & (abs(rest[:, 1] - 0.03) < 0.02)).sum() > 10
    touch.TornArea = 0
    closed = TouchStateSpace(Input=touch.Input, ActiveNode=touch.ActiveNode, Displacement=PULL,
                             DisplaySurface=fine)
    grid = fetch(closed)
    gaps = openings(grid, places(grid) - point_array(grid, "Displacement"))
    assert len(gaps) > 10 and max(gaps.values()) < 1e-4, gaps


def check_tear(touch, areas, energies):
    """A tear begins where a step to the next stage pays for itself, and goes on while G > G_c."""
    onset = (energies[0] - energies[1]) / areas[1]
    touch.TornArea = 0
    touch.FractureToughness = 1.01 * onset
    assert field(fetch(touch), "TornArea")[0] == 0
    touch.FractureToughness = 0.99 * onset
    torn = field(fetch(touch), "TornArea")[0]
    assert 0.5 * areas[1] <= torn <= areas[-1], (torn, areas, energies)
    # A tougher body tears less far, to where G is the toughness.
    touch.TornArea = areas[1]
    torn = []
    for toughness in onset * numpy.array([3, 1.5, 1, 0.7]):
        touch.FractureToughness = toughness
        found = fetch(touch)
        torn.append(field(found, "TornArea")[0])
        if areas[1] < torn[-1] < areas[-1]:
            assert numpy.isclose(field(found, "ReleaseRate")[0], toughness, rtol=1e-6)
    assert (numpy.diff(torn) >= 0).all() and torn[0] == areas[1] and torn[-1] > torn[0], torn


def test_cut_plane():
    """A plane by its end, its normal and a direction makes the cut of a sheet that is given."""
    grid = body("planes")
    end = {"Origin": [DEPTH, 0.03, HEIGHT], "Normal": [0, 0, 2]}
    given = fetch(PlaceCut(Input=grid, Sheet=sheet(), CutDirection=[1, 0, 0], StageSpacing=0.01))
    for direction in [1, 0, 0], [3, 0, 7], [0, 0, 0]:
        plane = CutPlane(Input=grid, CutDirection=direction, **end)
        cut = fetch(PlaceCut(Input=grid, Sheet=plane, StageSpacing=0.01))
        assert numpy.allclose(field(cut, "StageArea"), field(given, "StageArea"), rtol=1e-6)
    narrow = CutPlane(Input=grid, CutDirection=[1, 0, 0], Width=0.03, **end)
    area = field(fetch(PlaceCut(Input=grid, Sheet=narrow, StageSpacing=0.01)), "StageArea").ravel()
    assert 0.3 < area[-1] / field(given, "StageArea").ravel()[-1] < 0.8
    # From the side that is said, and at the middle of the body from any side.
    back = CutPlane(Input=grid, CutDirection=[-1, 0, 0], **end)
    front = point_array(fetch(back), "Front")
    assert numpy.allclose((places(fetch(back)) - places(fetch(back))[0])[:, 0], front[0] - front)
    middle = CutPlane(Input=grid, Origin=[x / 2 for x in LENGTHS], Normal=[0, 0, 1])
    assert fetch(PlaceCut(Input=grid, Sheet=middle)).GetNumberOfCells() > 0
    outside = {"Origin": [-1, 0.03, HEIGHT], "Normal": [0, 0, 1]}
    for wrong, *words in (
            ({**end, "CutDirection": [0, 0, 1]}, "along the normal"),
            ({**end, "Width": -1}, "Width"), ({**end, "Normal": [0, 0, 0]}, "Normal"),
            ({**outside, "CutDirection": [1, 0, 0]}, "before it comes to the body", "Origin")):
        expect_error(CutPlane(Input=grid, **wrong).UpdatePipeline, *words)


def test_tears_in_a_solve():
    """A body that is solved for tears as far as its stages, solved one by one, say."""
    boundary = boundary_at("torn", 0)
    tip = {"ActiveNodes": [node_at(boundary, TIP)], "TipRadius": 0.012}

    def pulled(scene, way=1.0, **properties):
        return fetch(SolveEquilibrium(Input=scene, Displacement=[way * x for x in PULL], **tip,
                                      **properties))

    areas = field(fetch(boundary), "StageArea").ravel()
    energies = numpy.array([field(pulled(boundary_at(f"torn{stage}", stage)), "Energy")[0]
                            for stage in range(len(areas))])
    rates = -numpy.diff(energies) / numpy.diff(areas)
    toughness = 0.99 * rates[0]
    stage = int(numpy.argmin([*(rates >= toughness), False]))
    torn = pulled(boundary, FractureToughness=toughness)
    assert field(torn, "Outcome")[0] == 0 and field(torn, "Stage")[0] == stage > 0
    assert numpy.isclose(field(torn, "Energy")[0], energies[stage], rtol=1e-6)
    assert numpy.isclose(field(torn, "TornArea")[0], areas[stage])
    table = field(torn, "Tears")
    assert numpy.allclose(table[:, 0], 1) and (table[:, 1] == numpy.arange(1, stage + 1)).all()
    assert numpy.allclose(table[:, 3:], numpy.transpose([energies[:stage], energies[1:stage + 1]]),
                          rtol=1e-6)
    if stage + 1 < len(areas):
        assert numpy.isclose(field(torn, "ReleaseRate")[0], rates[stage], rtol=1e-5)
    # The body is that of the stage, but for the numbers of the second copies of points.
    opened = fetch(boundary_at("opened", stage))
    first = fetch(boundary).GetNumberOfPoints()
    assert numpy.allclose(places(torn)[:first], places(opened)[:first])
    rows = [numpy.column_stack([places(grid), point_array(grid, "Fixed")])
            for grid in (torn, opened)]
    assert numpy.allclose(*[them[numpy.lexsort(numpy.round(them, 6).T)] for them in rows])
    whole = pulled(boundary, FractureToughness=1.01 * rates[0])
    assert field(whole, "Stage")[0] == 0 and not whole.GetFieldData().HasArray("Tears")
    assert numpy.isclose(field(whole, "ReleaseRate")[0], rates[0], rtol=1e-5)
    parts = pulled(boundary, FractureToughness=toughness, Increments=3)
    assert field(parts, "Stage")[0] == stage
    uncut = held_block("whole")
    tip["ActiveNodes"] = [node_at(uncut, TIP)]
    expect_error(SolveEquilibrium(Input=uncut, FractureToughness=1, **tip).UpdatePipeline,
                 "no cut along which it could tear", "Place Cut")
    tip["ActiveNodes"] = [node_at(boundary, TIP)]
    expect_error(SolveEquilibrium(Input=boundary, FractureToughness=-1, **tip).UpdatePipeline,
                 "no toughness", "Set FractureToughness")
    # A tissue of the list has its own, which a body of that size does not reach.
    boundary.Input.Law = "Liver"
    boundary.UpdatePipeline()
    assert (cell_array(fetch(boundary), "FractureToughness") == 164).all()
    liver = pulled(boundary, 0.5, FractureToughness=-1)
    assert field(liver, "Outcome")[0] == 0 and field(liver, "Stage")[0] == 0
    boundary.Input.Law = "Neo-Hookean"
    assert not fetch(boundary).GetCellData().HasArray("FractureToughness")


def held_block(name, quadratic=True):
    return hold(body(name, quadratic))


def test_cut_now():
    """A body is cut while it is held, along a sheet that lies on it as it is deformed."""
    boundary = held_block("now")
    for way in ([0, 0, 0.006], [0, 0, -0.004]):
        place = [LENGTHS[0] / 3, 0.03, LENGTHS[2]]
        tip = {"ActiveNodes": [node_at(boundary, place)], "TipRadius": 0.012}
        solved = SolveEquilibrium(Input=boundary, Displacement=way, **tip)
        solved.UpdatePipeline()
        cut = CutNow(Input=solved, Sheet=sheet())
        expect_silence(cut.UpdatePipeline)
        grid = fetch(cut)
        assert field(grid, "Stage")[0] == 1
        assert numpy.isclose(field(grid, "StageArea").ravel()[1], DEPTH * LENGTHS[1], rtol=0.05)
        # The sheet is where it lies on the deformed body.
        faces = fetch(PassThrough(Input=OutputPort(cut, 1)))
        here, moved = places(grid), point_array(grid, "Displacement")
        ids = [int(numpy.linalg.norm(here - at, axis=1).argmin()) for at in places(faces)]
        off = here[ids, 2] + moved[ids, 2] - HEIGHT
        assert abs(off).max() < 0.05 * abs(way[2]) < abs(moved[ids, 2]).max(), off
        # Supports and tissue stay: the body can be solved for at once.
        tip["ActiveNodes"] = [node_at(cut, place)]
        forces = []
        for begins_there in (0, 1):
            after = SolveEquilibrium(Input=cut, Displacement=way, **tip,
                                     StartFromDisplacement=begins_there)
            after = fetch(after)
            assert field(after, "Outcome")[0] == 0
            forces.append(field(after, "ReactionForce")[0])
            iterations = field(after, "Iterations")[0]
        assert numpy.allclose(*forces, rtol=1e-6), forces
        assert iterations < 40, iterations
        before = field(fetch(solved), "ReactionForce")[0]
        assert 0 < forces[1][2] / before[2] < 0.99, (forces, before)


def test_cut_now_again():
    """What is open stays open, and the sheet may be that of the body at rest."""
    boundary = held_block("again")
    first = CutNow(Input=boundary, Sheet=sheet(height=0.02))
    second = CutNow(Input=first, Sheet=sheet(height=0.042), OnDeformedBody=0)
    expect_silence(second.UpdatePipeline)
    area = field(fetch(second), "StageArea").ravel()[1]
    assert numpy.isclose(area, 2 * DEPTH * LENGTHS[1], rtol=0.01), area
    expect_error(PlaceCut(Input=first, Sheet=sheet()).UpdatePipeline, "has a cut already",
                 "Cut Now")
    expect_error(CutNow(Input=boundary, Sheet=sheet(0.2)).UpdatePipeline, "severs the body")
    expect_error(CutNow(Input=boundary, Sheet=sheet(), CutEdge=-1).UpdatePipeline, "CutEdge")
    # A body without tissue and supports is cut too.
    plain = fetch(CutNow(Input=body("plain"), Sheet=sheet()))
    assert not plain.GetPointData().HasArray("Fixed") and field(plain, "Stage")[0] == 1


def test_boundary_before_the_cut():
    """A cut may be placed in a body that is held already: it stays held at the same places."""
    boundary = held_block("held_before")
    before = fetch(PlaceCut(Input=boundary, Sheet=sheet(), CutDirection=[1, 0, 0], Stage=2))
    fixed = point_array(before, "Fixed")
    assert (fixed == (places(before)[:, 2] < 1e-9)).all()


def test_stages_that_cannot_be():
    boundary = two_stages("impossible")
    for properties, words in (({"Tool": "Sphere"}, ("the tool is rigid", "This Stage")),
                              ({"History": "Levels"}, ("History is Levels", "Flat")),
                              ({"MeshTolerance": 0.1}, ("MeshTolerance", "before Place Cut"))):
        refused = space_of_stages(boundary, **properties)
        if "Tool" in properties:
            refused.ActiveNodes = []
        expect_error(refused.UpdatePipeline, *words)
    # A single stage is a body like any other.
    alone = space_of_stages(boundary, CutStages="This Stage")
    touched = fetch(TouchStateSpace(Input=alone, Displacement=PULL))
    assert not touched.GetFieldData().HasArray("TornArea")


def test_contact_of_a_cut_needs_one():
    uncut = SetBoundary(Input=AssignMaterial(Input=body("uncut"), Law="Neo-Hookean"),
                        FixedRegion="Plane", Contact="Between Sides Of A Cut")
    expect_error(uncut.UpdatePipeline, "the body has no cut", "Place Cut")


def test_refused():
    through = PlaceCut(Input=body("through"), Sheet=sheet(0.2), CutDirection=[1, 0, 0])
    expect_error(through.UpdatePipeline, "severs the body", "Let the sheet end inside")
    beside = PlaceCut(Input=body("beside"), Sheet=sheet(height=1), CutDirection=[1, 0, 0])
    expect_error(beside.UpdatePipeline, "does not meet the body")
    fine = PlaceCut(Input=body("fine"), Sheet=sheet(), StageSpacing=0)
    expect_error(fine.UpdatePipeline, "StageSpacing")
    unknown = PlaceCut(Input=body("unknown"), Sheet=sheet(), FrontArray="way")
    expect_error(unknown.UpdatePipeline, "FrontArray is 'way'")


def test_linear_cells_and_a_front_array():
    way = Calculator(Input=sheet(), ResultArrayName="Way", Function="2*coordsX")
    cut = PlaceCut(Input=body("linear", quadratic=False), Sheet=way, FrontArray="Way",
                   StageSpacing=0.02, Stage=1)
    grid = fetch(cut)
    assert numpy.allclose(field(grid, "StageFront").ravel(), 0.02 * numpy.arange(5))
    assert numpy.isclose(field(grid, "StageArea").ravel()[1], 0.01 * LENGTHS[1])


if __name__ == "__main__":
    for test_name, test in list(globals().items()):
        if test_name.startswith("test_"):
            test()
            print(test_name, "passed", flush=True)
