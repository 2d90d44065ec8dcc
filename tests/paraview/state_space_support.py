# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of state spaces share: a small space, and the space as numbers."""

import numpy
from paraview import servermanager
from paraview.simple import PrecomputeStateSpace
from support import places
from vtkmodules.util.numpy_support import vtk_to_numpy

BLOCKS = ("Body", "Surface", "Configurations")
ADDED_BLOCK = "IntermediateStates"
# Figures of a run: no two are alike.
TIMES = {"Seconds"}


def precompute(boundary, nodes, **settings):
    # A space in a file is compared with one in memory, to the bit; test_stress.py has one that
    # keeps less.
    settings = {"HalfWidth": 0.02, "Resolution": 5, "Keep": "All", **settings}
    return PrecomputeStateSpace(Input=boundary, ActiveNodes=nodes, **settings)


def fetch_space(proxy):
    """The blocks by name, as they are on rank 0."""
    proxy.UpdatePipeline()
    collection = servermanager.Fetch(proxy, 0)
    assert collection.IsA("vtkPartitionedDataSetCollection"), collection.GetClassName()
    names = [collection.GetMetaData(i).Get(collection.NAME())
             for i in range(collection.GetNumberOfPartitionedDataSets())]
    expected = [*BLOCKS, *[ADDED_BLOCK] * (ADDED_BLOCK in names)]
    # A space of several bodies has a block for each.
    expected += [f"Body{number + 2}" for number in range(len(names) - len(expected))]
    assert names == expected, names
    return {name: collection.GetPartition(i, 0) for i, name in enumerate(names)}


def arrays_of(attributes):
    arrays = [attributes.GetArray(i) for i in range(attributes.GetNumberOfArrays())]
    return {array.GetName(): vtk_to_numpy(array) for array in arrays if array}


def expect_same_space(a, b, tolerance=0):
    """Every array of every block is equal, times of runs apart."""
    assert a.keys() == b.keys(), (a.keys(), b.keys())
    for name in a:
        assert a[name].GetClassName() == b[name].GetClassName()
        assert (places(a[name]) == places(b[name])).all()
        assert a[name].GetNumberOfCells() == b[name].GetNumberOfCells()
        for kind in ("GetPointData", "GetCellData"):
            ours, theirs = (arrays_of(getattr(block[name], kind)()) for block in (a, b))
            assert ours.keys() == theirs.keys(), (ours.keys(), theirs.keys())
            for array in ours.keys() - TIMES:
                assert numpy.allclose(ours[array], theirs[array], rtol=tolerance, atol=0), array
    hashes = [block["Configurations"].GetFieldData().GetAbstractArray("SceneHash").GetValue(0)
              for block in (a, b)]
    assert hashes[0] == hashes[1]
