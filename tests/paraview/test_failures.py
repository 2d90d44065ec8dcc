# SPDX-License-Identifier: BSD-3-Clause
"""Input that is refused, on one rank and on two: one error, which a script can see, and the process
goes on; data of the user that looks like a failure and is none; and a wish that the program end."""

import signal

from paraview.simple import (AccuracyReport, AssignMaterial, Calculator, EstimateError,
                             GroupDatasets, PrecomputeStateSpace, SetBoundary, SolveEquilibrium,
                             Sphere,
                             StateSpaceReader, TetrahedralizeSurface, TouchStateSpace)
from state_space_support import precompute
from support import (box_body, expect_error, expect_silence, fetch, field, node_at, scene, source)
from vtkmodules.vtkCommonCore import vtkStringArray

COLLECTIONS = ("vtkMultiBlockDataSet", "vtkPartitionedDataSetCollection")


def error_code(proxy):
    proxy.UpdatePropertyInformation()
    return proxy.GetPropertyValue("ErrorCode")


def group(member, kind):
    grouped = GroupDatasets(Input=[member])
    grouped.OutputType = kind
    grouped.UpdatePipeline()
    return grouped


def test_collections_are_refused():
    boundary = scene("collections", quadratic=False)
    node = node_at(boundary, [0.2, 0.1, 0.1])
    space = precompute(boundary, [node], Resolution=3)
    on_body = {AssignMaterial: {}, SetBoundary: {}, SolveEquilibrium: {"ActiveNodes": [node]},
               PrecomputeStateSpace: {"ActiveNodes": [node], "Resolution": 3}}
    cases = [(boundary, "collection", on_body),
             (space, "no state space",
              {TouchStateSpace: {}, EstimateError: {}, AccuracyReport: {}})]
    for member, words, filters in cases:
        for kind in COLLECTIONS:
            grouped = group(member, kind)
            for make, settings in filters.items():
                print(make.__name__, kind, flush=True)
                refused = make(Input=grouped, **settings)
                expect_error(refused.UpdatePipeline, words)
                assert error_code(refused) != 0, make.__name__
    # All is well afterwards.
    assert field(expect_silence(lambda: fetch(TouchStateSpace(Input=space))), "Found")[0] == 1


def test_the_error_code():
    """That of a filter tells also of a failure before it, and is 0 again after a success."""
    boundary = scene("code", quadratic=False)
    node = node_at(boundary, [0.2, 0.1, 0.1])
    space = precompute(boundary, [node], Resolution=4)
    touch, estimate = TouchStateSpace(Input=space), EstimateError(Input=space)
    expect_error(touch.UpdatePipeline, "resolution")
    estimate.UpdatePipeline()
    assert all(error_code(proxy) != 0 for proxy in (space, touch, estimate))
    assert error_code(boundary) == 0
    # Nothing is tried again, nor told again, before something has changed.
    for proxy in (space, touch, estimate):
        expect_silence(proxy.UpdatePipeline)
    space.Resolution = 3
    expect_silence(touch.UpdatePipeline)
    assert error_code(space) == error_code(touch) == 0
    reader = StateSpaceReader(FileName="missing.palpate")
    expect_error(reader.UpdatePipeline, "missing.palpate")
    assert error_code(reader) != 0


def test_one_message_through_a_stock_filter():
    material = AssignMaterial(Input=source(box_body(quadratic=False), "stock"), PoissonsRatio=0.7)
    between = Calculator(Input=material, ResultArrayName="One", Function="1")
    boundary = SetBoundary(Input=between)
    expect_error(boundary.UpdatePipeline, "Poisson's ratio")
    assert error_code(boundary) != 0


def test_an_array_of_the_user_is_no_failure():
    """Whatever it is called, and whatever is in it."""
    grid = box_body(quadratic=False)
    error = vtkStringArray()
    error.SetName("Error")
    error.InsertNextValue("of the scanner: 0.3 mm")
    grid.GetFieldData().AddArray(error)
    boundary = SetBoundary(Input=AssignMaterial(Input=source(grid, "named"), Law="Neo-Hookean"),
                           FixedRegion="Plane")
    boundary.FixedRegion.Origin = [0, 0, 0]
    boundary.FixedRegion.Normal = [1, 0, 0]
    result = expect_silence(lambda: fetch(boundary))
    assert result.GetNumberOfCells() == grid.GetNumberOfCells()
    assert result.GetFieldData().GetAbstractArray("Error").GetValue(0) == error.GetValue(0)
    space = precompute(boundary, [node_at(boundary, [0.2, 0.1, 0.1])], Resolution=3)
    assert field(expect_silence(lambda: fetch(TouchStateSpace(Input=space))), "Found")[0] == 1
    assert error_code(space) == 0


def is_handled(number):
    """Whether anything handles a signal, as the system tells."""
    with open("/proc/self/status", encoding="utf-8") as status:
        caught = next(line for line in status if line.startswith("SigCgt:"))
    return int(caught.split()[1], 16) >> (number - 1) & 1 == 1


def test_a_wish_to_end_is_not_handled_while_a_filter_computes():
    """VTK's log handles it, and may wait for ever; what a script has set is left alone."""
    assert is_handled(signal.SIGTERM)
    solve = SolveEquilibrium(Input=scene("ends"), Displacement=[0.001, 0, 0])
    solve.ActiveNodes = [node_at(solve.Input, [0.2, 0.1, 0.1])]
    handled = []
    algorithm = solve.SMProxy.GetClientSideObject()
    algorithm.AddObserver("ProgressEvent", lambda *_: handled.append(is_handled(signal.SIGTERM)))
    solve.UpdatePipeline()
    assert False in handled, handled
    assert is_handled(signal.SIGTERM)
    signal.signal(signal.SIGTERM, lambda *_: None)
    handled.clear()
    solve.Displacement = [0.002, 0, 0]
    solve.UpdatePipeline()
    assert handled and False not in handled, handled
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


for name, test in list(globals().items()):
    if name.startswith("test_"):
        print(name, flush=True)
        test()
