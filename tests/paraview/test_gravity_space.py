# SPDX-License-Identifier: BSD-3-Clause
"""State spaces of a body that rests under its weight, on one rank and on two."""

import glob
import os

import numpy
from accuracy_support import columns, fetch_report, row
from paraview import servermanager
from paraview.simple import (AccuracyReport, AssignMaterial, EstimateError, OpenDataFile,
                             PrecomputeStateSpace, SaveData, SetBoundary, SolveEquilibrium,
                             StateSpaceReader, TouchStateSpace)
from state_space_support import expect_same_space, fetch_space
from support import (box_body, expect_error, expect_silence, field, node_at, places,
                     point_array, source)

GRAVITY = [0, 0, -9.81]
RADIUS = 0.04
# Shares of the largest: what is interpolated between check-points.
FORCE_BETWEEN = 0.01
SHAPE_BETWEEN = 0.02


def heavy(name, divisions=(4, 2, 2), density=500):
    body = source(box_body(divisions, quadratic=False), name)
    boundary = SetBoundary(Input=AssignMaterial(Input=body, Law="Neo-Hookean", Density=density),
                           FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    return boundary


def fetch(proxy, port=0):
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy, 0, idx=port)


def remove(name):
    for path in glob.glob(f"{name}*"):
        os.remove(path)


def share(found, right):
    return numpy.abs(found - right).max() / numpy.abs(right).max()


def test_bonded():
    boundary = heavy("gravity_space")
    node = node_at(boundary, [0.2, 0.1, 0.1])
    remove("gravity.palpate")
    settings = {"ActiveNodes": [node], "HalfWidth": 0.01, "Resolution": 5, "BodyForce": GRAVITY}
    space = PrecomputeStateSpace(Input=boundary, FileName="gravity.palpate", Keep="All",
                                 **settings)
    assert list(space.BodyForce) == GRAVITY
    blocks = expect_silence(lambda: fetch_space(space))
    solve = SolveEquilibrium(Input=boundary, ActiveNodes=[node], Displacement=[0, 0, 0],
                             BodyForce=GRAVITY, Stress=1)
    rest = fetch(solve)
    sag = point_array(rest, "Displacement")
    assert sag[node, 2] < -0.005
    # The body is as its mesh, and the surface as it lies.
    mesh = places(fetch(boundary))
    assert (places(blocks["Body"]) == mesh).all()
    assert numpy.abs(point_array(blocks["Body"], "RestDisplacement") - sag).max() < 1e-9
    surface_points = point_array(blocks["Surface"], "MeshPoint")
    lies = (mesh + sag)[surface_points]
    assert numpy.abs(places(blocks["Surface"]) - lies).max() < 1e-7

    touch = TouchStateSpace(Input=space, ActiveNode=node, Displacement=[0, 0, 0], Stress=1,
                            WholeBody=1)
    surface, body = expect_silence(lambda: (fetch(touch), fetch(touch, 1)))
    assert numpy.abs(places(surface) - lies).max() < 1e-6
    assert numpy.abs(field(surface, "Force")).max() < 1e-6
    assert share(point_array(body, "CauchyStress"), point_array(rest, "CauchyStress")) < 1e-5
    t = [0.004, -0.003, 0.007]
    touch.Displacement = solve.Displacement = t
    surface, body = expect_silence(lambda: (fetch(touch), fetch(touch, 1)))
    exact = fetch(solve)
    u = point_array(exact, "Displacement")
    assert share(field(surface, "Force"), field(exact, "ReactionForce")) < FORCE_BETWEEN
    moved = field(exact, "Energy")[0] - field(rest, "Energy")[0]
    assert numpy.isclose(field(surface, "Energy")[0], moved, rtol=FORCE_BETWEEN)
    largest = numpy.linalg.norm(t)
    for grid, of in ((surface, surface_points), (body, slice(None))):
        assert numpy.abs(places(grid) - (mesh + u)[of]).max() < SHAPE_BETWEEN * largest
        from_rest = (u - sag)[of]
        error = numpy.abs(point_array(grid, "Displacement") - from_rest).max()
        assert error < SHAPE_BETWEEN * largest
    assert share(point_array(body, "CauchyStress"), point_array(exact, "CauchyStress")) < 0.02

    # By a stock writer and its reader, and from the file.
    SaveData("gravity.vtpc", proxy=space, DataMode="Binary")
    for other in (OpenDataFile("gravity.vtpc"), StateSpaceReader(FileName="gravity.palpate")):
        again = TouchStateSpace(Input=other, ActiveNode=node, Displacement=t)
        assert (places(fetch(again)) == places(surface)).all()
        assert (field(fetch(again), "Force") == field(surface, "Force")).all()
    expect_same_space(fetch_space(StateSpaceReader(FileName="gravity.palpate")), blocks)

    errors = expect_silence(lambda: fetch_space(EstimateError(Input=space)))
    assert (point_array(errors["Configurations"], "EstimatedError") >= 0).all()
    report = AccuracyReport(Input=space, TestPoints=20, LogInterval=0)
    table = columns(expect_silence(lambda: fetch_report(report))[0])
    best = row(table, "Energy Hermite", 5)
    assert best["Counted"] == 20 and 0 < best["MeanError"] < 0.1, best

    # The estimate before the start.
    space.InvokeCommand("UpdateEstimate")
    space.UpdatePropertyInformation()
    assert "130 configurations" in space.GetPropertyValue("Estimate")
    for other in ([0, 0, 0], [0, 0, -9.8]):
        settings["BodyForce"] = other
        wrong = PrecomputeStateSpace(Input=boundary, FileName="gravity.palpate", Keep="All",
                                     **settings)
        expect_error(wrong.UpdatePipeline, "another scene", "BodyForce")


def test_rigid_tool():
    boundary = heavy("gravity_contact", (8, 4, 4), density=200)
    remove("gravity_contact.palpate")
    node = node_at(boundary, [0.125, 0.05, 0.1])
    # A layer that is given is smooth, so that few check-points do.
    tool = {"Tool": "Sphere", "ToolRadius": RADIUS, "ContactThickness": 0.2 * RADIUS}
    solve = SolveEquilibrium(Input=boundary, BodyForce=GRAVITY, ToolPosition=[0.125, 0.05, 0.2],
                             **tool)
    sag = point_array(fetch(solve), "Displacement")
    assert sag[node, 2] < -0.002
    top = numpy.array([0.125, 0.05, 0.1]) + sag[node]
    space = PrecomputeStateSpace(Input=boundary, Depth=0.01, Spacing=0.015, UseToolRegion=1,
                                 ToolRegion="Sphere", LogInterval=0, Keep="All",
                                 FileName="gravity_contact.palpate", ThirdDerivatives=1,
                                 BodyForce=GRAVITY, **tool)
    space.ToolRegion.Center, space.ToolRegion.Radius = list(top), 0.025
    above = list(top + [0, 0, RADIUS - 0.006])
    touch = TouchStateSpace(Input=space, ToolPosition=above, WholeBody=1, Stress=1)
    touched, body = expect_silence(lambda: (fetch(touch), fetch(touch, 1)))
    solve.ToolPosition, solve.Stress = above, 1
    exact = fetch(solve)
    force = field(exact, "ReactionForce")[0]
    assert force[2] < -0.1
    assert numpy.linalg.norm(field(touched, "Force")[0] - force) < 0.03 * numpy.linalg.norm(force)
    u = point_array(exact, "Displacement")
    mesh = places(fetch(boundary))
    # The bounds are those of a space without gravity.
    allowed = 0.05 * numpy.abs(u - sag).max()
    assert numpy.abs(places(body) - mesh - u).max() < allowed
    surface_points = point_array(fetch_space(space)["Surface"], "MeshPoint")
    assert numpy.abs(places(touched) - (mesh + u)[surface_points]).max() < allowed
    assert abs(field(touched, "ContactArea")[0] / field(exact, "ContactArea")[0] - 1) < 0.1
    assert share(point_array(body, "CauchyStress"), point_array(exact, "CauchyStress")) < 0.1
    # Away from the body as it lies it feels nothing, where the mesh was too.
    touch.ToolPosition = [top[0], top[1], 0.1 + 1.01 * RADIUS + 0.2 * RADIUS]
    away, body = expect_silence(lambda: (fetch(touch), fetch(touch, 1)))
    assert (field(away, "Force") == 0).all() and (point_array(away, "Displacement") == 0).all()
    assert numpy.abs(places(body) - mesh - sag).max() < 1e-9

    report = AccuracyReport(Input=space, TestPoints=20, LogInterval=0)
    table = expect_silence(lambda: fetch_report(report))[0]
    found = columns(table)
    best = found["Method"] == "Energy Hermite"
    assert (found["Failed"] == 0).all() and (found["MeanError"][best] < 3).all(), found


def test_bad_input():
    boundary = heavy("gravity_bad", density=0)
    node = node_at(boundary, [0.2, 0.1, 0.1])
    settings = {"ActiveNodes": [node], "Resolution": 3}
    expect_error(PrecomputeStateSpace(Input=boundary, BodyForce=GRAVITY, **settings).UpdatePipeline,
                 "no density", "Density")
    soft = heavy("gravity_soft", density=1e7)
    expect_error(PrecomputeStateSpace(Input=soft, BodyForce=GRAVITY, **settings).UpdatePipeline,
                 "finds no rest", "BodyForce")


if __name__ == "__main__":
    for test_name, test in list(globals().items()):
        if test_name.startswith("test_"):
            test()
            print(test_name, "passed", flush=True)
