# SPDX-License-Identifier: BSD-3-Clause
"""SolveEquilibrium with rigid tools that press, on a small body and beside another code."""

import json
import os

import numpy
from paraview.simple import (AssignMaterial, Box, SetBoundary, SolveEquilibrium, Sphere,
                             Triangulate, XMLUnstructuredGridReader)
from support import (Messages, box_body, expect_error, expect_silence, fetch, field, message,
                     places, point_array, produce, source)
from vtkmodules.vtkFiltersSources import vtkSphereSource

# Longer than the edges of the cubes, 0.025 m, and of their diagonals.
RADIUS = 0.04
# The box of support.py is 0.2 m long, 0.1 m wide and high, and is held at x = 0. This is above the
# middle of its top, where the tool is this deep in it.
DEPTH = 0.01
POSITION = [0.11, 0.05, 0.1 + RADIUS - DEPTH]


def fine_scene(name):
    body = source(box_body(divisions=(8, 4, 4)), name)
    boundary = SetBoundary(Input=AssignMaterial(Input=body, Law="Neo-Hookean"),
                           FixedRegion="Plane")
    boundary.FixedRegion.Origin = [0, 0, 0]
    boundary.FixedRegion.Normal = [1, 0, 0]
    return boundary


def press(boundary, **settings):
    settings = {"Tool": "Sphere", "ToolRadius": RADIUS, "ToolPosition": POSITION} | settings
    return SolveEquilibrium(Input=boundary, **settings)


def solve(boundary, **settings):
    return expect_silence(lambda: fetch(press(boundary, **settings)))


def sphere_surface():
    """Quadrilaterals, and triangles around the poles. Where it lies does not matter."""
    sphere = vtkSphereSource()
    sphere.SetRadius(RADIUS)
    sphere.SetCenter(1, 2, 3)
    sphere.SetThetaResolution(48)
    sphere.SetPhiResolution(24)
    sphere.LatLongTessellationOn()
    sphere.Update()
    return produce(sphere.GetOutput())


def test_output():
    boundary = fine_scene("contact")
    after = solve(boundary)
    assert field(after, "Outcome")[0] == 0
    assert field(after, "Flags")[0] == 0
    assert message(after) == ""
    force = field(after, "ReactionForce")
    assert force.shape == (1, 3)
    # The mesh is not its own mirror image.
    assert force[0, 2] < 0 and abs(force[0, 1]) < 0.05 * abs(force[0, 2])
    assert field(after, "HapticStiffness").shape == (1, 9)
    assert field(after, "Energy")[0] > 0
    pressure = point_array(after, "ContactPressure")
    top = places(after)[:, 2] > 0.0999
    assert pressure.min() >= 0 and pressure[top].max() > 0
    assert (pressure[~top] == 0).all()
    area = field(after, "ContactArea")[0]
    assert 0 < area < numpy.pi * RADIUS ** 2


def test_forces_are_derivatives_of_the_energy():
    boundary = fine_scene("contact_derivative")
    step = 1e-4
    middle = solve(boundary)
    up, down = (solve(boundary, ToolPosition=numpy.add(POSITION, [0, 0, s]).tolist())
                for s in (step, -step))
    force = (field(up, "Energy")[0] - field(down, "Energy")[0]) / (2 * step)
    assert abs(force / field(middle, "ReactionForce")[0, 2] - 1) < 1e-3
    stiffness = (field(up, "ReactionForce")[0] - field(down, "ReactionForce")[0]) / (2 * step)
    assert numpy.allclose(stiffness, field(middle, "HapticStiffness").reshape(3, 3)[2],
                          atol=1e-3 * numpy.abs(stiffness).max())


def test_away():
    boundary = fine_scene("contact_away")
    after = solve(boundary, ToolPosition=[0.11, 0.05, 0.2])
    for name in ("ReactionForce", "HapticStiffness", "Energy", "ContactArea"):
        assert (field(after, name) == 0).all(), name
    assert (point_array(after, "Displacement") == 0).all()


def test_tools_agree():
    """A capsule without length, and the surface of a sphere, are a sphere."""
    boundary = fine_scene("contact_tools")
    force = field(solve(boundary), "ReactionForce")[0]
    capsule = field(solve(boundary, Tool="Capsule", ToolLength=0), "ReactionForce")[0]
    assert numpy.linalg.norm(capsule - force) < 1e-8 * numpy.linalg.norm(force)
    of_surface = field(solve(boundary, Tool="Surface", ToolSurface=sphere_surface()),
                       "ReactionForce")[0]
    # The polyhedron is smaller than its sphere by 0.2 % of the radius, of a depth of a third.
    assert numpy.linalg.norm(of_surface - force) < 0.02 * numpy.linalg.norm(force)
    longer = field(solve(boundary, Tool="Capsule", ToolLength=0.04), "ReactionForce")[0]
    assert longer[2] < 1.2 * force[2]


def test_the_layer_of_contact_is_told():
    """By default the tool seems as large as it is; with a thickness that is given, larger."""
    boundary = fine_scene("contact_layer")
    calibrated = solve(boundary)
    thick = solve(boundary, ContactThickness=0.2 * RADIUS)
    force, larger = (-field(found, "ReactionForce")[0, 2] for found in (calibrated, thick))
    assert larger > 1.3 * force, (larger, force)
    by_default, told = (field(found, "ContactLayerForce")[0] for found in (calibrated, thick))
    assert abs(by_default) < 0.05 * force, (by_default, force)
    assert abs((larger - told) / force - 1) < 0.1, (larger, told, force)
    # Edges of 25 mm to 35 mm under a contact of about 20 mm.
    assert 0.02 < field(calibrated, "ContactMeshError")[0] < 0.3


def test_a_tool_inside_is_told():
    """Small beside the cells, it goes through the surface: that is no equilibrium."""
    boundary = fine_scene("contact_inside")
    with Messages() as messages:
        found = fetch(press(boundary, ToolRadius=0.003, ToolPosition=[0.117, 0.055, 0.073],
                            ContactThickness=0.0012))
    assert field(found, "Outcome")[0] == 7
    assert "goes through the surface" in message(found), message(found)
    assert message(found) in messages.text and messages.errors == 0
    # The last of the way that is contact.
    assert field(found, "ReactionForce")[0, 2] < 0


def test_a_plate_is_larger_than_the_body():
    """Without contraction, the force is that of a bar: E A times the strain."""
    side, height, share = 0.04, 0.02, 0.1
    body = source(box_body((6, 6, 3), (side, side, height)), "under_a_plate")
    boundary = SetBoundary(Input=AssignMaterial(Input=body, Law="Linear", YoungsModulus=5e3,
                                                PoissonsRatio=0), FixedRegion="Plane")
    boundary.FixedRegion.Origin = [0, 0, 0]
    boundary.FixedRegion.Normal = [0, 0, 1]
    plate = Triangulate(Input=Box(XLength=0.09, YLength=0.09, ZLength=0.01))
    after = fetch(press(boundary, Tool="Surface", ToolSurface=plate,
                        ToolPosition=[side / 2, side / 2, (1 - share) * height + 0.005]))
    assert field(after, "Outcome")[0] == 0, message(after)
    force = field(after, "ReactionForce")[0]
    bar = 5e3 * side ** 2 * share
    assert abs(-force[2] - bar) < 0.05 * bar, (force, bar)
    assert numpy.abs(force[:2]).max() < 1e-6 * bar, force
    assert field(after, "ContactArea")[0] > 0.99 * side ** 2


def test_a_coarse_mesh_is_told():
    boundary = fine_scene("contact_coarse")
    with_small_tool = press(boundary, ToolRadius=0.004, ToolPosition=[0.11, 0.05, 0.1025])

    with Messages() as messages:
        fetch(with_small_tool)
    assert messages.warnings == 1 and messages.errors == 0
    assert "Mesh the body more finely" in messages.text
    assert "too large by about" in messages.text


def test_bad_input():
    boundary = fine_scene("contact_bad")

    def run(**settings):
        return lambda: fetch(press(boundary, **settings))

    expect_error(run(ToolRadius=0), "radius")
    expect_error(run(Tool="Capsule", ToolAxis=[0, 0, 0]), "axis")
    expect_error(run(ContactThickness=-1), "thickness")
    expect_error(run(ContactStiffness=-1), "stiffness")
    expect_error(run(Tool="Surface"), "Tool Surface")
    expect_error(run(Tool="Surface", ToolSurface=Sphere(Radius=RADIUS, EndTheta=180)), "open")
    expect_error(run(ToolPosition=[float("nan"), 0, 0]), "not finite")


def test_reference():
    """The liver, pressed by a sphere, as another code has solved it.

    That code slid each tool to its place from somewhere else. In the first case it lies at a ridge,
    and the body has two equilibria that are stable: straight along the normal it comes to the one
    of less energy.
    """
    name = os.path.join(os.environ.get("PALPATE_SHARED_DATA", ""), "liver_contact_reference.json")
    if not os.path.exists(name):
        print("There is no reference data here.")
        return
    with open(name) as file:
        reference = json.load(file)
    body = XMLUnstructuredGridReader(
        FileName=[os.path.join(os.path.dirname(name), reference["scene"])])
    material = AssignMaterial(Input=body, Law=reference["law"],
                              YoungsModulus=reference["YoungsModulus"],
                              PoissonsRatio=reference["PoissonsRatio"])
    worst = dict.fromkeys(("force", "energy", "stiffness"), 0.0)
    for number, case in enumerate(reference["cases"]):
        grid = fetch(SolveEquilibrium(
            Input=material, Tool="Sphere", ToolRadius=reference["radius"],
            ToolPosition=case["centre"], ContactThickness=reference["thickness"],
            ContactStiffness=reference["stiffness"]))
        assert field(grid, "Outcome")[0] == 0
        if number == 0:
            assert 0.8 < field(grid, "Energy")[0] / case["energy"] < 0.9
            assert field(grid, "NegativePivots")[0] == 0
            continue
        for ours, name, theirs in (
                (field(grid, "ReactionForce")[0], "force", case["force"]),
                (field(grid, "Energy"), "energy", [case["energy"]]),
                (field(grid, "HapticStiffness").reshape(3, 3), "stiffness", case["stiffness"])):
            error = numpy.linalg.norm(ours - numpy.array(theirs)) / numpy.linalg.norm(theirs)
            worst[name] = max(worst[name], error)
    print(len(reference["cases"]), "cases, largest relative errors:", worst)
    # The other code integrates contact at nine times as many points.
    assert max(worst.values()) < 5e-3


if __name__ == "__main__":
    for test_name, test in list(globals().items()):
        if test_name.startswith("test_"):
            test()
            print(test_name, "passed", flush=True)
