# SPDX-License-Identifier: BSD-3-Clause
"""Parts of a body that touch each other: Set Boundary, and solves."""

import numpy
from paraview.simple import (AppendDatasets, AssignMaterial, SetBoundary, SolveDynamics,
                             SolveEquilibrium)
from support import (box_body, cell_array, expect_error, expect_silence, fetch, field, message,
                     point_array, source)

RADIUS = 0.02
BED_HEIGHT = 0.03
ORGAN_HEIGHT = 0.024
TOP = BED_HEIGHT + ORGAN_HEIGHT
# Over the middle of the organ.
MIDDLE = (0.055, 0.05)


def moved(grid, way):
    for point in range(grid.GetNumberOfPoints()):
        grid.GetPoints().SetPoint(point, numpy.array(grid.GetPoint(point)) + way)
    return grid


def parts(name):
    """An organ that lies on a bed, with meshes that do not match."""
    bed = source(box_body((5, 5, 1), (0.11, 0.1, BED_HEIGHT)), name + "_bed")
    organ = source(moved(box_body((4, 3, 1), (0.07, 0.06, ORGAN_HEIGHT)), (0.02, 0.02, BED_HEIGHT)),
                   name + "_organ")
    return AssignMaterial(Input=AppendDatasets(Input=[bed, organ]), Law="Neo-Hookean",
                          YoungsModulus=5e3, PoissonsRatio=0.4, Density=1000)


def held(body, **settings):
    """The bed is fixed at its bottom, and the organ is drawn to where it lies by springs."""
    bed = SetBoundary(Input=body, FixedRegion="Plane", **settings)
    bed.FixedRegion.Origin = [0, 0, 1e-6]
    bed.FixedRegion.Normal = [0, 0, 1]
    organ = SetBoundary(Input=bed, Support="Springs", SupportStiffness=2e3, FixedRegion="Box")
    organ.FixedRegion.Position = [0.0195, 0.0195, BED_HEIGHT + 1e-4]
    organ.FixedRegion.Length = [0.071, 0.061, 1]
    return organ


def press(boundary, depth, **settings):
    return SolveEquilibrium(Input=boundary, Tool="Sphere", ToolRadius=RADIUS,
                            ToolPosition=[*MIDDLE, TOP + RADIUS - depth], Increments=2, **settings)


def test_an_organ_presses_its_bed():
    boundary = held(parts("bed"), Contact="Between Parts")
    scene = expect_silence(lambda: fetch(boundary))
    assert sorted(set(cell_array(scene, "ContactPart"))) == [0, 1]
    kind, thickness, stiffness = field(scene, "PartContact")[0]
    assert (kind, stiffness) == (1, 0)
    assert 0.002 < thickness < 0.006
    after = fetch(press(boundary, 0.008))
    assert field(after, "Outcome")[0] == 0, message(after)
    on_bed, on_organ = field(after, "PartForce")
    assert on_bed[2] < -0.05
    assert numpy.linalg.norm(on_bed + on_organ) < 1e-8 * numpy.linalg.norm(on_bed)
    pressure = point_array(after, "PartPressure")
    assert pressure.max() > 0
    assert pressure.min() >= 0
    gap = point_array(after, "PartGap")
    assert numpy.isnan(gap).any()
    assert -thickness < numpy.nanmin(gap) < 0
    assert 0 < field(after, "PartPenetration")[0] < thickness
    # The parts lie on each other: a hard surface would give way less.
    of_layer = field(after, "PartLayerForce")[0]
    force = field(after, "ReactionForce")[0]
    assert 0.01 < numpy.dot(of_layer, force) / -numpy.dot(force, force) < 0.3, (of_layer, force)
    thin = fetch(press(held(parts("thin"), Contact="Between Parts",
                            ContactThickness=thickness / 4), 0.008))
    assert (numpy.linalg.norm(field(thin, "PartLayerForce")[0])
            < 0.5 * numpy.linalg.norm(of_layer))
    # Without contact the organ hangs in its springs.
    without = fetch(press(held(parts("loose")), 0.008))
    assert (-field(without, "ReactionForce")[0][2]
            < 0.8 * -field(after, "ReactionForce")[0][2])


def test_what_is_refused():
    body = parts("array")
    expect_error(lambda: fetch(held(body, Contact="Between Parts", PartsBy="Array",
                                    PartArray="Law")), "one part", "PartArray")
    expect_error(lambda: fetch(held(body, Contact="Between Parts", PartsBy="Array",
                                    PartArray="nobody")), "nobody", "PartsBy")


def test_contact_alone_holds_nothing():
    body = SetBoundary(Input=parts("loose_part"), FixedRegion="Plane", Contact="Between Parts")
    body.FixedRegion.Origin = [0, 0, 1e-6]
    body.FixedRegion.Normal = [0, 0, 1]
    for solve in (lambda: fetch(press(body, 0.008)),
                  lambda: SolveDynamics(Input=body, EndTime=0.02,
                                        BodyForce=[0, 0, -9.81]).UpdatePipeline()):
        expect_error(solve, "part 1", "ContactPart", "Springs", "Contact alone")


def test_motion():
    boundary = held(parts("motion"), Contact="Between Parts")
    motion = SolveDynamics(Input=boundary, BodyForce=[0, 0, -9.81], EndTime=0.02, TimeStep=0.005)
    after = fetch(motion)
    assert field(after, "Outcome")[0] == 0, message(after)
    assert field(after, "PartForce").shape == (2, 3)


if __name__ == "__main__":
    for test_name, test in list(globals().items()):
        if test_name.startswith("test_"):
            test()
            print(test_name, "passed", flush=True)
