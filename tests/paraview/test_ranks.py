# SPDX-License-Identifier: BSD-3-Clause
"""The filters on several ranks: wherever the cells are, the result is whole on rank 0."""

import numpy
from paraview import servermanager, simple
from paraview.simple import (AssignMaterial, SetBoundary, SolveEquilibrium,
                             XMLPartitionedUnstructuredGridReader)
from support import (box_body, expect_error, expect_silence, fetch, field, grid_of, places,
                     point_array, source)
from vtkmodules.vtkCommonCore import vtkIdTypeArray
from vtkmodules.vtkCommonDataModel import VTK_TETRA

PARTITIONED = """<?xml version="1.0"?>
<VTKFile type="PUnstructuredGrid" version="0.1" byte_order="LittleEndian">
  <PUnstructuredGrid GhostLevel="0">
    <PPoints><PDataArray type="Float64" Name="Points" NumberOfComponents="3"/></PPoints>
    {arrays}
    {pieces}
  </PUnstructuredGrid>
</VTKFile>
"""


GLOBAL_IDS = ('<PPointData GlobalIds="Ids"><PDataArray type="Int64" IdType="1" Name="Ids"/>'
              '</PPointData>')


def partitioned(name, pieces, arrays=""):
    """A reader that gives the first rank the first of the files, and so on."""
    with open(name + ".pvtu", "w") as file:
        file.write(PARTITIONED.format(
            arrays=arrays, pieces="".join(f'<Piece Source="{piece}.vtu"/>' for piece in pieces)))
    return XMLPartitionedUnstructuredGridReader(FileName=[name + ".pvtu"])


def halves(name, grid, with_ids):
    """The body cut at x = 0.1, with the points of the cut in both pieces."""
    cells = [[grid.GetCell(c).GetPointId(i) for i in range(grid.GetCell(c).GetNumberOfPoints())]
             for c in range(grid.GetNumberOfCells())]
    # The second half first, so that the order of the points is not that of the pieces.
    for number, side in enumerate((1, -1)):
        own = [cell for cell in cells if side * (places(grid)[cell, 0].mean() - 0.1) > 0]
        used = sorted({point for cell in own for point in cell})
        half = grid_of(places(grid)[used], [[used.index(p) for p in cell] for cell in own],
                       grid.GetCellType(0))
        if with_ids:
            ids = vtkIdTypeArray()
            ids.SetName("Ids")
            for point in used:
                ids.InsertNextValue(point)
            half.GetPointData().SetGlobalIds(ids)
        source(half, f"{name}{number}")
    return partitioned(name, [name + "0", name + "1"], GLOBAL_IDS if with_ids else "")


def road(body, grid=None):
    material = AssignMaterial(Input=body, Law="Neo-Hookean")
    boundary = SetBoundary(Input=material, FixedRegion="Plane")
    boundary.FixedRegion.Origin = [0, 0, 0]
    boundary.FixedRegion.Normal = [1, 0, 0]
    points = places(grid or box_body())
    node = int(numpy.argmin(numpy.linalg.norm(points - [0.2, 0.1, 0.1], axis=1)))
    return SolveEquilibrium(Input=boundary, ActiveNodes=[node], Displacement=[0.01, 0.005, 0])


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


def test_pieces(grid, alone):
    """A body on both ranks: its points are joined by their global ids, in the order of those."""
    result = expect_silence(lambda: fetch(road(halves("numbered", grid, True))))
    assert result.GetNumberOfCells() == grid.GetNumberOfCells()
    assert (places(result) == places(grid)).all()
    assert close(field(result, "ReactionForce"), field(alone, "ReactionForce"))

    plain = halves("plain", grid, False)
    expect_error(lambda: fetch(road(plain)), "2 pieces", "Generate Global Ids")
    # From ParaView 5.13 on it has the longer name.
    give_ids = getattr(simple, "GlobalPointAndCellIds", None) or simple.GenerateGlobalIds
    numbered = give_ids(Input=plain)
    whole = fetch(AssignMaterial(Input=numbered))
    assert whole.GetNumberOfPoints() == grid.GetNumberOfPoints()
    result = expect_silence(lambda: fetch(road(numbered, whole)))
    assert close(field(result, "ReactionForce"), field(alone, "ReactionForce"))


def close(ours, theirs):
    return numpy.abs(ours - theirs).max() <= 1e-9 * numpy.abs(theirs).max()


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
    of_ranks = [point_array(result, "Displacement") for result in results]
    assert (of_ranks[0] == of_ranks[1]).all()

    test_group(first, results[0])
    test_pieces(grid, results[0])

    expect_error(lambda: fetch(road(partitioned("nothing", ["none", "none"]))), "no cells")
    assert field(fetch(road(first)), "Outcome")[0] == 0
    print("passed")


if __name__ == "__main__":
    main()
