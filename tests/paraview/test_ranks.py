# SPDX-License-Identifier: BSD-3-Clause
"""The filters on several ranks: wherever the cells are, the result is whole on rank 0."""

import numpy
from paraview import servermanager
from paraview.simple import (AssignMaterial, SetBoundary, SolveEquilibrium,
                             XMLPartitionedUnstructuredGridReader)
from support import (box_body, expect_error, expect_silence, fetch, field, grid_of, places,
                     point_array, source)
from vtkmodules.vtkCommonDataModel import VTK_TETRA

PARTITIONED = """<?xml version="1.0"?>
<VTKFile type="PUnstructuredGrid" version="0.1" byte_order="LittleEndian">
  <PUnstructuredGrid GhostLevel="0">
    <PPoints><PDataArray type="Float64" Name="Points" NumberOfComponents="3"/></PPoints>
    {pieces}
  </PUnstructuredGrid>
</VTKFile>
"""


def partitioned(name, pieces):
    """A reader that gives the first rank the first of the files, and so on."""
    with open(name + ".pvtu", "w") as file:
        file.write(PARTITIONED.format(
            pieces="".join(f'<Piece Source="{piece}.vtu"/>' for piece in pieces)))
    return XMLPartitionedUnstructuredGridReader(FileName=[name + ".pvtu"])


def road(body):
    material = AssignMaterial(Input=body, Law="Neo-Hookean")
    boundary = SetBoundary(Input=material, FixedRegion="Plane")
    boundary.FixedRegion.Origin = [0, 0, 0]
    boundary.FixedRegion.Normal = [1, 0, 0]
    node = int(numpy.argmin(numpy.linalg.norm(places(box_body()) - [0.2, 0.1, 0.1], axis=1)))
    return SolveEquilibrium(Input=boundary, ActiveNode=[node], Displacement=[0.01, 0.005, 0])


def test_group(body, alone):
    """Both ranks solve one body together: the same equilibrium but for rounding."""
    together = road(body)
    together.GroupUnknowns = 0
    for increments in (1, 2):
        together.Increments = increments
        result = expect_silence(lambda: fetch(together))
        for name, get in (("ReactionForce", field), ("Energy", field), ("HapticStiffness", field),
                          ("Displacement", point_array)):
            expected = get(alone, name)
            assert numpy.abs(get(result, name) - expected).max() <= 1e-9 * numpy.abs(
                expected).max(), name
    # The other rank is let go where the first one fails.
    together.TipRadius = 1
    expect_error(lambda: fetch(together), "fixed")
    together.TipRadius, together.LinearSolver = 0, "Eigen LDLT"
    assert field(expect_silence(lambda: fetch(together)), "Outcome")[0] == 0


def main():
    assert servermanager.vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions() == 2
    grid = box_body()
    first = source(grid, "whole")
    last = partitioned("last", ["none", "whole"])
    source(grid_of([(0, 0, 0)], [], VTK_TETRA), "none")

    results = []
    for body in (first, last):
        equilibrium = road(body)
        result = expect_silence(lambda: fetch(equilibrium))
        assert result.GetNumberOfCells() == grid.GetNumberOfCells()
        assert (places(result) == places(grid)).all()
        assert field(result, "Outcome")[0] == 0
        results.append(result)
    for name in ("ReactionForce", "Energy", "HapticStiffness"):
        assert (field(results[0], name) == field(results[1], name)).all()
    assert (point_array(results[0], "Displacement") == point_array(results[1], "Displacement")).all()

    test_group(first, results[0])

    expect_error(lambda: fetch(road(partitioned("spread", ["whole", "whole"]))),
                 "spread over 2 ranks")
    expect_error(lambda: fetch(road(partitioned("nothing", ["none", "none"]))), "no cells")
    assert field(fetch(road(first)), "Outcome")[0] == 0
    print("passed")


if __name__ == "__main__":
    main()
