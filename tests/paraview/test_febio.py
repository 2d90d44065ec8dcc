# SPDX-License-Identifier: BSD-3-Clause
"""A scene to FEBio's file and back, by ParaView's own ways to save and to open."""

import os
import re

import numpy
from paraview.simple import (AssignMaterial, Calculator, FEBioReader, OpenDataFile, SaveData,
                             SetBoundary, SolveEquilibrium)
from support import (EDGES, Messages, box_body, cell_array, expect_error, expect_silence, fetch,
                     field, grid_of, node_at, places, point_array, source)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, VTK_TETRA

HELP = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "plugin", "help")


def arrays_of(grid):
    """The values of all arrays that have a name, by where they are and their name."""
    arrays = {}
    for kind in ("Point", "Cell", "Field"):
        data = getattr(grid, f"Get{kind}Data")()
        for i in range(data.GetNumberOfArrays()):
            array = data.GetAbstractArray(i)
            arrays[kind, array.GetName()] = [
                array.GetVariantValue(k).ToString() for k in range(array.GetNumberOfValues())]
    return arrays


def documented_arrays():
    """Those of which the pages say that they make up a scene."""
    names = set()
    for page in ("AssignMaterial.md", "SetBoundary.md"):
        with open(os.path.join(HELP, page), encoding="utf-8") as text:
            row = next(line for line in text if line.startswith("| output"))
        names.update(re.findall(r"`([A-Z]\w+)`", row))
    return names


def oriented(grid):
    """The same body, whose cells are all right-handed, as FEBio needs them."""
    points, cells = places(grid), []
    for cell in range(grid.GetNumberOfCells()):
        ids = grid.GetCell(cell).GetPointIds()
        nodes = [ids.GetId(i) for i in range(ids.GetNumberOfIds())]
        edges = points[nodes[1:4]] - points[nodes[0]]
        if numpy.linalg.det(edges) < 0:
            # Corners 2 and 3 change places, and the midside nodes with them.
            order = [0, 1, 3, 2]
            midsides = {frozenset(edge): node for edge, node in zip(EDGES, nodes[4:])}
            nodes = [nodes[i] for i in order] + [
                midsides[frozenset(order[i] for i in edge)] for edge in EDGES if midsides]
        cells.append(nodes)
    return grid_of(points, cells, VTK_TETRA if len(cells[0]) == 4 else VTK_QUADRATIC_TETRA)


def scene_of(quadratic, name, **rheology):
    """Two regions of different laws, with values that no short fraction holds; held at x = 0."""
    body = source(oriented(box_body(quadratic=quadratic)), name)
    whole = AssignMaterial(Input=body, Law="Neo-Hookean", PoissonsRatio=1 / 3, **rheology)
    varied = Calculator(Input=whole, AttributeType="Cell Data", ResultArrayName="YoungsModulus",
                        Function="YoungsModulus / 3")
    part = AssignMaterial(Input=varied, Law="Mooney-Rivlin", RegionType="Shape",
                          RegionShape="Plane")
    part.RegionShape.Origin, part.RegionShape.Normal = [0.1, 0, 0], [1, 0, 0]
    boundary = SetBoundary(Input=part, FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    return boundary


def expect_same(one, other):
    assert (places(one) == places(other)).all()
    for get in ("GetConnectivityArray", "GetOffsetsArray"):
        assert (vtk_to_numpy(getattr(one.GetCells(), get)())
                == vtk_to_numpy(getattr(other.GetCells(), get)())).all(), get
    # All arrays, and no list of them: what the file loses is found here.
    first, second = arrays_of(one), arrays_of(other)
    # The parts have numbers and names where the body has none.
    for key in set(second) - set(first) & {("Cell", "RegionId"), ("Field", "Regions")}:
        del second[key]
    assert set(first) == set(second), set(first) ^ set(second)
    for key, values in first.items():
        assert values == second[key], key


def solve(scene):
    node = node_at(scene, [0.2, 0.1, 0.1])
    solved = expect_silence(lambda: fetch(SolveEquilibrium(
        Input=scene, ActiveNodes=[node], Displacement=[0.01, 0, -0.02])))
    assert field(solved, "Outcome")[0] == 0
    return point_array(solved, "Displacement"), field(solved, "ReactionForce")


def test_round_trip():
    for quadratic in (False, True):
        scene = scene_of(quadratic, f"body{quadratic}", Density=1060.1, PronyModuli=[0.5, 1 / 3],
                         PronyTimes=[0.1 / 3, 1])
        name = os.path.abspath(f"body{quadratic}.feb")
        expect_silence(lambda: SaveData(name, proxy=scene))
        back = expect_silence(lambda: OpenDataFile(name))
        assert back.GetXMLName() == "FEBioReader", back.GetXMLName()
        grid = expect_silence(lambda: fetch(back))
        expect_same(fetch(scene), grid)
        regions = grid.GetFieldData().GetAbstractArray("Regions")
        names = [regions.GetValue(i) for i in range(regions.GetNumberOfValues())]
        assert names == ["Body", "Body_2"], names
        assert set(cell_array(grid, "RegionId")) == {0, 1}
        for one, other in zip(solve(scene), solve(back)):
            assert (one == other).all(), abs(one - other).max()

        # Once more, from what was read: RegionId now is there.
        again = os.path.abspath("again.feb")
        expect_silence(lambda: SaveData(again, proxy=back))
        expect_same(grid, expect_silence(lambda: fetch(OpenDataFile(again))))


def supported(scene, place, normal, **settings):
    """The same with another support or load of the points at a plane."""
    further = SetBoundary(Input=scene, FixedRegion="Plane", LoadRegion="Plane", **settings)
    for region in (further.FixedRegion, further.LoadRegion):
        region.Origin, region.Normal = place, normal
    return further


def test_planes_of_symmetry_and_loads_come_back():
    for quadratic in (False, True):
        scene = scene_of(quadratic, f"quarter{quadratic}")
        for place, axis in (([0, 0, 0], [0, 1, 0]), ([0, 0, 0], [0, 0, 1])):
            scene = supported(scene, place, axis, Support="Direction", HeldDirection=axis)
        scene = supported(scene, [0.2, 0, 0], [-1, 0, 0], Support="Nothing", Load="Traction",
                          AppliedTraction=[1 / 3, 0, -1 / 7])
        scene = SetBoundary(Input=scene, Support="Nothing", Load="Pressure", LoadBy="Surface",
                            AppliedPressure=100 / 3)
        grid = fetch(scene)
        name = os.path.abspath(f"quarter{quadratic}.feb")
        with Messages() as messages:
            SaveData(name, proxy=scene)
        assert messages.warnings == 1 and messages.errors == 0, messages.text
        assert "'LoadedArea' (field)" in messages.text, messages.text
        back = OpenDataFile(name)
        read = expect_silence(lambda: fetch(back))
        assert point_array(read, "HeldDirection").any()
        assert point_array(read, "AppliedPressure").any()
        assert point_array(read, "HeldDirection2").any(), "along the edge of both planes"
        grid.GetFieldData().RemoveArray("LoadedArea")
        expect_same(grid, read)
        for one, other in zip(solve(scene), solve(back)):
            assert (one == other).all(), abs(one - other).max()


def test_supports_that_febio_has_not_are_named():
    scene = scene_of(False, "named")
    for settings, words in (
            ({"Support": "Direction", "HeldDirection": [1, 1, 0]}, "HeldDirection that is not"),
            ({"Support": "Springs"}, "SupportStiffness is left out")):
        with Messages() as messages:
            SaveData("named.feb", proxy=supported(scene, [0.2, 0, 0], [-1, 0, 0], **settings))
        assert messages.warnings == 1 and messages.errors == 0, messages.text
        assert words in messages.text, messages.text


def test_every_array_comes_back_or_is_named():
    """A scene with all that the pages name: each array is in the file, or in the warning."""
    body = box_body(quadratic=True)
    body = oriented(body)
    shade = numpy_to_vtk(numpy.arange(body.GetNumberOfCells()), deep=True)
    shade.SetName("Shade")
    body.GetCellData().AddArray(shade)
    material = AssignMaterial(
        Input=source(body, "all"), Law="Mooney-Rivlin", Formulation="Mixed", Density=1060,
        ViscousTime=0.02, PronyModuli=[0.5, 1 / 3, 0.2, 0.1], PronyTimes=[0.1, 1 / 3, 1, 7])
    soft = AssignMaterial(Input=material, Law="Neo-Hookean", PoissonsRatio=0.3,
                          Formulation="Mixed", RegionType="Shape", RegionShape="Plane")
    soft.RegionShape.Origin, soft.RegionShape.Normal = [0.1, 0, 0], [1, 0, 0]
    scene = SetBoundary(Input=soft, FixedRegion="Plane", Merge=1)
    scene.FixedRegion.Origin, scene.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    side = [0.2, 0, 0], [-1, 0, 0]
    scene = supported(scene, [0, 0, 0], [0, 0, 1], Support="Direction")
    scene = supported(scene, *side, Support="Springs", Load="Traction")
    scene = SetBoundary(Input=scene, Support="Nothing", Load="Pressure", LoadBy="Surface",
                        Contact="Also With Themselves")
    grid = fetch(scene)
    missing = documented_arrays() - {name for _, name in arrays_of(grid)}
    assert not missing, f"the scene of this test has no {missing}"

    name = os.path.abspath("all.feb")
    with Messages() as messages:
        SaveData(name, proxy=scene)
    assert messages.warnings == 1 and messages.errors == 0, messages.text
    before, after = arrays_of(grid), arrays_of(expect_silence(lambda: fetch(OpenDataFile(name))))
    lost = {key[1] for key, values in before.items() if values != after.get(key)}
    assert lost == {"Shade", "ViscousTime", "Formulation", "MergedPoints", "SupportStiffness",
                    "LoadedArea", "BoundaryKind", "ContactPart", "PartContact"}, lost
    lost.remove("BoundaryKind")  # follows from the rest
    for array in lost:
        assert array in messages.text, (array, messages.text)


def test_what_is_said_once():
    scene = scene_of(True, "faults")
    incompressible = AssignMaterial(Input=scene, Law="Neo-Hookean incompressible")
    expect_error(lambda: SaveData("refused.feb", proxy=incompressible),
                 "Neo-Hookean incompressible cannot be written", "Assign Mooney-Rivlin")
    assert not os.path.exists("refused.feb")
    body = source(box_body(), "bare")
    expect_error(lambda: SaveData("bare.feb", proxy=body), "Apply Assign Material")
    expect_error(lambda: SaveData("nowhere/body.feb", proxy=scene), "No such file")
    # Written once, and so warned of once.
    nearly = AssignMaterial(Input=scene, Law="Neo-Hookean", PoissonsRatio=0.49)
    with Messages() as messages:
        SaveData("nearly.feb", proxy=nearly)
    assert messages.warnings == 1 and messages.errors == 0, messages.text
    expect_same(fetch(nearly), expect_silence(lambda: fetch(OpenDataFile(
        os.path.abspath("nearly.feb")))))


def test_reader():
    folder = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "data")
    name = os.path.join(folder, "febio_25.feb")
    reader = FEBioReader(FileName=name)
    expect_error(reader.UpdatePipeline, "does not say its units", "Set Units")
    reader.UpdatePropertyInformation()
    assert reader.GetPropertyValue("ErrorCode") != 0
    for units, length, pressure in (
            ("SI", 1, 1), ("mm-N-s", 1e-3, 1e6), ("mm-kg-s", 1e-3, 1e3), ("um-nN-s", 1e-6, 1e3),
            ("CGS", 1e-2, 0.1), ("mm-g-s", 1e-3, 1), ("mm-mg-s", 1e-3, 1e-3)):
        reader.Units = units
        grid = expect_silence(lambda: fetch(reader))
        assert (cell_array(grid, "YoungsModulus") == 5 * pressure).all(), units
        assert (places(grid).max(axis=0) == 2 * length).all(), units
    assert reader.GetPropertyValue("Units") == "mm-mg-s"
    expect_error(FEBioReader().UpdatePipeline, "Set FileName")

    loaded = FEBioReader(FileName=os.path.join(folder, "febio_30.feb"))
    with Messages() as messages:
        loaded.UpdatePipeline()
    assert messages.warnings == 1 and messages.errors == 0, messages.text
    assert "Pressure1" in messages.text and "Pull" in messages.text, messages.text


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(name, "passed", flush=True)
