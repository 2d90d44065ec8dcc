# SPDX-License-Identifier: BSD-3-Clause
"""Cuts in a body: Place Cut, and the stages that follow from it."""

import numpy
from paraview.simple import (AssignMaterial, Calculator, OutputPort, PassThrough, PlaceCut, Plane,
                             SetBoundary, SolveEquilibrium)
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


def boundary_at(name, stage, **contact):
    """The body with its cut open up to a stage, held at its bottom."""
    cut = PlaceCut(Input=body(name), Sheet=sheet(), CutDirection=[1, 0, 0], StageSpacing=0.01,
                   Stage=stage)
    boundary = SetBoundary(Input=AssignMaterial(Input=cut, Law="Neo-Hookean"),
                           FixedRegion="Plane", **contact)
    boundary.FixedRegion.Origin = [0, 0, 1e-6]
    boundary.FixedRegion.Normal = [0, 0, 1]
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
