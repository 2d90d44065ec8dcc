# SPDX-License-Identifier: BSD-3-Clause
"""A result is that of the properties and arrays that it depends on: each of them is changed, one
by one, in a filter that has run and in one with the file of another run, and a filter that has
never run says what is right.

Every property of the filters is named here, so that a new one cannot be forgotten.
"""

import contextlib
import os
import shutil

import numpy
from paraview import servermanager
from paraview.simple import (AssignMaterial, BuildReducedModel, GetSources, PrecomputeStateSpace,
                             SetBoundary)
from state_space_support import TIMES, arrays_of
from support import Messages, box_body, delete_all, node_at, produce
from vtkmodules.util.numpy_support import vtk_to_numpy

CORNER = (0.2, 0.1, 0.1)
# Of forces, of their largest: a file has what a solver of another precision has found.
SAME = 1e-6
# What says where a result is kept, or how it is computed or told, and not what it is.
NO_EFFECT = {"Threads", "LogInterval", "UpdateEstimate", "UpdateInterval", "FileName"}


def held(grid, **material):
    material = {"Law": "Neo-Hookean", "YoungsModulus": 5000, "PoissonsRatio": 0.4,
                "Density": 1000, **material}
    boundary = SetBoundary(Input=AssignMaterial(Input=produce(grid), **material),
                           FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    return boundary


def body():
    return held(box_body((2, 1, 1), quadratic=False))


def leaves(data):
    """The data sets of an output."""
    if not data.IsA("vtkPartitionedDataSetCollection"):
        return [data]
    return [data.GetPartition(i, 0) for i in range(data.GetNumberOfPartitionedDataSets())
            if data.GetNumberOfPartitions(i)]


def numbers(data):
    """Every number of an output, by where it stands."""
    result = {}
    for i, leaf in enumerate(leaves(data)):
        kinds = (["GetRowData"] if leaf.IsA("vtkTable") else ["GetPointData", "GetCellData"])
        for kind in kinds + ["GetFieldData"]:
            for name, array in arrays_of(getattr(leaf, kind)()).items():
                if not (name in TIMES or name.endswith("Seconds") or name.endswith("Step")):
                    result[i, kind, name] = array
        if not leaf.IsA("vtkTable") and leaf.GetNumberOfPoints():
            result[i, "places"] = vtk_to_numpy(leaf.GetPoints().GetData())
    return result


def outcome(proxy):
    """The numbers of a filter; None where it refuses."""
    with Messages():
        proxy.UpdatePipeline()
        proxy.UpdatePropertyInformation()
    if proxy.GetPropertyValue("ErrorCode") != 0:
        return None
    ports = range(proxy.GetNumberOfOutputPorts())
    return {(port, *key): array for port in ports
            for key, array in numbers(servermanager.Fetch(proxy, 0, idx=port)).items()}


def differences(ours, theirs):
    """Where two results differ, to the bit; a NaN is equal to a NaN."""
    if ours is None or theirs is None:
        return [] if ours is theirs else ["one of them is refused"]
    return [key for key in sorted(ours.keys() | theirs.keys(), key=str)
            if key not in ours or key not in theirs or ours[key].shape != theirs[key].shape
            or not numpy.array_equal(ours[key], theirs[key],
                                     equal_nan=ours[key].dtype.kind == "f")]


def changeable(proxy):
    """The properties that a user sets."""
    for name in proxy.ListProperties():
        sm_property = proxy.GetProperty(name).SMProperty
        if not sm_property.GetInformationOnly() and sm_property.GetCommand():
            yield name


def owner(proxy, name):
    """The filter that has a property, and its name there: Input.Load is one of the input."""
    *way, name = name.split(".")
    for step in way:
        proxy = getattr(proxy, step)
    return proxy, name


def change(proxy, name, value):
    """Sets a property; one that is another proxy gets its own properties set."""
    proxy, name = owner(proxy, name)
    if isinstance(value, dict):
        for part, number in value.items():
            setattr(getattr(proxy, name), part, number)
    else:
        setattr(proxy, name, value)


def held_in(proxy, name, value):
    """What a property has, of the kind of `value`."""
    proxy, name = owner(proxy, name)
    if isinstance(value, dict):
        return {part: held_in(getattr(proxy, name), part, number)
                for part, number in value.items()}
    # A copy: ParaView gives what goes on showing the value of the property.
    has = proxy.GetPropertyValue(name)
    if isinstance(has, servermanager.Proxy):
        return has.SMProxy.GetXMLLabel()
    if isinstance(value, str):
        return str(has).strip("'")
    return list(has) if isinstance(value, list) else has


@contextlib.contextmanager
def made(make):
    """What make() gives, for as long as the context lasts: ParaView makes a source more slowly, the
    more of them there are."""
    before = set(GetSources())
    yield make()
    delete_all(before)


def check_properties(make, changes):
    """A filter that has run gives what one that has not gives, whatever is changed.
    @param make makes a filter that has not run. @param changes other values by property.
    @returns the properties that the result depends on."""
    ran = make()
    before = {name: held_in(ran, name, value) for name, value in changes.items()}
    base = outcome(ran)
    assert base is not None
    effects = set()
    for name, value in changes.items():
        with made(make) as fresh:
            change(fresh, name, value)
            right = outcome(fresh)
        change(ran, name, value)
        assert not differences(outcome(ran), right), name
        change(ran, name, before[name])
        if differences(right, base):
            effects.add(name)
    assert not differences(outcome(ran), base)
    return effects


def states(result):
    """What is known of each configuration, by its key."""
    columns = {name: array for (block, kind, name), array in
               ((key[1:], array) for key, array in result.items() if len(key) == 4)
               if (block, kind) == (2, "GetPointData")}
    keys = zip(columns["ActiveNode"], map(tuple, columns["CheckPoint"]), columns["Level"])
    return {key: numpy.concatenate([numpy.ravel(columns[name][i]) for name in
                                    ("Displacement", "Energy", "Force", "Stiffness", "Outcome",
                                     "Flags")]) for i, key in enumerate(keys)}


def with_file_of_another(make, changes, file):
    """For each change its name, and what comes of it without a file and with that of a filter that
    is not changed."""
    with made(make) as kept:
        kept.FileName = file
        assert outcome(kept) is not None
    shutil.copy(file, "base.palpate")
    for name, value in changes.items():
        results = []
        for file_name in ("", file):
            shutil.copy("base.palpate", file)
            with made(make) as proxy:
                proxy.FileName = file_name
                change(proxy, name, value)
                results.append(outcome(proxy))
        yield name, *results


def check_file(make, changes, file):
    """A filter that finds the file of another one has each configuration that it has without, and
    it is the same, or it refuses. (The file may have more.)
    @returns the properties for which it refuses."""
    refused = set()
    for name, without, result in with_file_of_another(make, changes, file):
        if result is None:
            refused.add(name)
            continue
        right, found = states(without), states(result)
        assert right.keys() <= found.keys(), name
        scale = numpy.max(numpy.abs(list(right.values())), axis=0)
        for key, row in right.items():
            assert (abs(found[key] - row) <= SAME * scale).all(), (name, key)
        # What is drawn has the error that was asked for; with other nodes theirs counts too.
        error = (0, 2, "GetFieldData", "DisplacementError")
        assert name == "ActiveNodes" or result[error] <= without[error], name
    return refused


# They mean nothing without a MeshTolerance, without a cut, or without a tool that is turned.
NEED_MORE = {"RegionSize": 0.06, "MaximumCells": 100000, "CutStages": "This Stage",
             "TurnSpacing": 20}
# It changes what is rounded, if anything: on Debian 13 nothing.
ROUNDING = {"SinglePrecisionFactors"}
# Other values of the properties of a space.
OF_BOTH = {"ForceLimit": 0.5, "ThirdDerivatives": 0, "SolverTolerance": 1e-6,
           "SinglePrecisionFactors": 0, "MaximumSeconds": 60, "BodyForce": [0, 0, -1],
           "Keep": "All", "RanksPerSolve": 2, "Graspable": 1, "EstimateMeshError": 1,
           "MeshTolerance": 0.1, **NEED_MORE}
OF_BONDED = {"TipRadius": 0.11, "HalfWidth": 0.012, "Resolution": 5, "Tolerance": 0.05,
             "ToleranceType": "Absolute", "History": "Levels", "IntermediateStates": 1,
             "DisplacementBound": 0.1}
OF_RIGID = {"UseToolRegion": 0, "ToolRegion": {"Center": [0.21, 0.1, 0.1]}, "Depth": 0.004,
            "Spacing": 0.02, "BeginAt": [0.1, 0, 0], "MaximumConfigurations": 10}
# How much is found before the body is touched.
BEFORE = {"Exploration": "Around The Hand"}
OF_TOOL = {"Tool.Radius": 0.04, "Tool.Axis": [0, 1, 0], "Tool.Length": 0.02,
           "Tool.ContactThickness": 0.008, "Tool.ContactStiffness": 3000}


def test_bonded_space():
    boundary = body()
    node, other = (node_at(boundary, place) for place in (CORNER, (0.2, 0, 0)))

    def make():
        return PrecomputeStateSpace(Input=boundary, ActiveNodes=[node], HalfWidth=0.01,
                                    Resolution=3, LogInterval=0)

    changes = {**OF_BOTH, **OF_BONDED, "ActiveNodes": [other]}
    assert set(changeable(make())) == set(changes) | set(OF_RIGID) | set(BEFORE) | NO_EFFECT | {
        "Input", "Tool", "ToolSurface"}
    # Each of the others is without a meaning here, or does not change what is found.
    assert check_properties(make, changes) - ROUNDING == set(changes) - ROUNDING - {
        "Graspable", "Keep", "MaximumSeconds", "ToleranceType", *NEED_MORE}
    # By a file that is there, what is to be found may be more, and otherwise computed or drawn.
    changes["DisplacementBound"] = 1e-5
    assert check_file(make, changes, "bonded.palpate") == set(changes) - {
        "ActiveNodes", "EstimateMeshError", "ForceLimit", "Graspable", "History",
        "MaximumSeconds", "SinglePrecisionFactors", "ToleranceType", *NEED_MORE}


def test_rigid_space():
    boundary = body()

    def make():
        proxy = PrecomputeStateSpace(Input=boundary, Tool="Capsule", ToolRadius=0.03,
                                     ToolLength=0.01, Depth=0.005, Spacing=0.03,
                                     UseToolRegion=1, ToolRegion="Sphere", LogInterval=0)
        proxy.ToolRegion.Center, proxy.ToolRegion.Radius = [0.2, 0.1, 0.1], 0.02
        return proxy

    tool = make().Tool
    assert {"Tool." + name for name in changeable(tool)} == {*OF_TOOL, "Tool.Motion"}
    changes = {**OF_BOTH, **OF_RIGID, **OF_TOOL, "Tool": "Sphere"}
    all_changes = changes | BEFORE
    assert check_properties(make, all_changes) - ROUNDING == set(all_changes) - ROUNDING - {
        "BeginAt", "Keep", "MaximumSeconds", *NEED_MORE}
    assert check_file(make, changes, "rigid.palpate") == set(changes) - {
        "BeginAt", "Depth", "EstimateMeshError", "ForceLimit", "MaximumSeconds",
        "SinglePrecisionFactors", "ToolRegion", "UseToolRegion", *NEED_MORE}


def on_plane(body, origin, normal, **settings):
    """A boundary of the points on the side of a plane that its normal points away from."""
    boundary = SetBoundary(Input=body, FixedRegion="Plane", LoadRegion="Plane", **settings)
    for region in (boundary.FixedRegion, boundary.LoadRegion):
        region.Origin, region.Normal = origin, normal
    return boundary


def supported_and_loaded():
    """Fixed at one end, on springs, on a plane, under a pressure and a traction."""
    springs = on_plane(body(), [0, 0, 0], [0, 1, 0], Support="Springs", SupportStiffness=1e4)
    plane = on_plane(springs, [0, 0, 0], [0, 0, 1], Support="Direction", HeldDirection=[0, 0, 1])
    pressed = SetBoundary(Input=plane, Support="Nothing", Load="Pressure", AppliedPressure=50,
                          LoadBy="Surface")
    return on_plane(pressed, [0.2, 0, 0], [-1, 0, 0], Support="Nothing", Load="Traction",
                    AppliedTraction=[0, 0, -20])


def test_supports_and_loads():
    node = node_at(body(), CORNER)

    def make():
        return PrecomputeStateSpace(Input=supported_and_loaded(), ActiveNodes=[node],
                                    HalfWidth=0.005, Resolution=3, LogInterval=0)

    traction, pressure = "Input.", "Input.Input."
    plane, springs = "Input.Input.Input.", "Input.Input.Input.Input."
    changes = {traction + "AppliedTraction": [0, 10, -20], traction + "Load": "None",
               traction + "LoadRegion": {"Origin": [0.1, 0, 0]}, pressure + "AppliedPressure": 60,
               plane + "HeldDirection": [0, 1, 1], plane + "Support": "Fixed",
               springs + "SupportStiffness": 2e4,
               springs + "FixedRegion": {"Origin": [0, 0.1, 0]}}
    assert check_properties(make, changes) == set(changes)
    assert check_file(make, changes, "loaded.palpate") == set(changes)


def body_with(fixed_at=0, touchable=False, region=None, boundary=None, **material):
    """@param region where the second material begins, m, and what is different in it.
    @param boundary what holds and loads the side z = 0 besides."""
    grid = box_body((4, 1, 1), quadratic=False)
    same = {"Law": "Neo-Hookean", "YoungsModulus": 5000, "PoissonsRatio": 0.4, "Density": 1000,
            "ViscousTime": 0.01, **material}
    whole = AssignMaterial(Input=produce(grid), **same)
    if region:
        start, other = region
        whole = AssignMaterial(Input=whole, RegionType="Shape", RegionShape="Plane",
                               **{**same, **other})
        whole.RegionShape.Origin, whole.RegionShape.Normal = [start, 0, 0], [-1, 0, 0]
    fixed = SetBoundary(Input=whole, FixedRegion="Plane")
    fixed.FixedRegion.Origin, fixed.FixedRegion.Normal = [fixed_at, 0, 0], [1, 0, 0]
    return on_plane(fixed, [0, 0, 0], [0, 0, 1], **boundary) if boundary else fixed


DENSE, STIFF, VISCOUS = {"Density": 20000}, {"YoungsModulus": 9000}, {"ViscousTime": 0.05}
BODIES = {
    "as it is": {}, "law": {"Law": "St. Venant-Kirchhoff"}, "stiffness": STIFF,
    "Poisson's ratio": {"PoissonsRatio": 0.3}, "density": {"Density": 1100},
    "viscous time": VISCOUS, "Prony series": {"PronyModuli": [0.5], "PronyTimes": [0.1]},
    "fixed points": {"fixed_at": 0.051},
    "plane": {"boundary": {"Support": "Normal"}},
    "springs": {"boundary": {"Support": "Springs", "SupportStiffness": 2e4}},
    "stiff springs": {"boundary": {"Support": "Springs", "SupportStiffness": 3e4}},
    "traction": {"boundary": {"Support": "Nothing", "Load": "Traction",
                              "AppliedTraction": [0, 5, -5]}},
    "dense half": {"region": (0.1, DENSE)}, "dense end": {"region": (0.15, DENSE)},
    "stiff half": {"region": (0.1, STIFF)}, "stiff end": {"region": (0.15, STIFF)},
    "viscous half": {"region": (0.1, VISCOUS)}, "viscous end": {"region": (0.15, VISCOUS)}}


def check_bodies(make, file):
    """What finds the file of another body gives what it gives without a file, or refuses."""
    bodies = {name: body_with(**settings) for name, settings in BODIES.items()}

    def found(boundary, file):
        with made(lambda: make(boundary, file)) as proxy:
            return outcome(proxy)

    right = {name: found(boundary, "") for name, boundary in bodies.items()}
    for name, result in right.items():
        assert all(differences(result, right[other]) for other in right if other != name), name
    for body_of_file in ("dense half", "stiff half", "viscous half", "springs"):
        if os.path.exists(file):
            os.remove(file)
        assert not differences(found(bodies[body_of_file], file), right[body_of_file])
        shutil.copy(file, "base.palpate")
        for name, boundary in bodies.items():
            shutil.copy("base.palpate", file)
            result = found(boundary, file)
            assert result is None or not differences(result, right[name]), (body_of_file, name)


def test_reduced_model():
    boundary = body()
    node, other = (node_at(boundary, place) for place in (CORNER, (0.2, 0, 0)))

    def make():
        return BuildReducedModel(Input=boundary, ActiveNodes=[node], Reach=0.01, Modes=4,
                                 TrainingPaths=1, PathDuration=0.04, TestPaths=0)

    changes = {"ActiveNodes": [other], "TrainingPlaces": [other], "TipRadius": 0.11,
               "Reach": 0.012, "BodyForce": [0, 0, -1], "Modes": 3, "Tolerance": 0.3,
               "MaximumPoints": 5, "TrainingPaths": 2, "PathDuration": 0.05, "Bandwidth": 20,
               "Taps": 100, "ShortestTap": 0.01, "TimeStep": 0.003, "Seed": 2, "TestPaths": 1,
               "SolverTolerance": 1e-6}
    assert set(changeable(make())) == set(changes) | {"FileName", "Input"}
    base = outcome(make())
    effects, refused = set(), set()
    for name, right, found in with_file_of_another(make, changes, "model.palpate"):
        if found is None:
            refused.add(name)
        else:
            assert not differences(found, right), name
        if differences(right, base):
            effects.add(name)
    assert effects == set(changes), set(changes) - effects
    assert refused == {"SolverTolerance"}, refused


def test_bodies():
    def reduced(boundary, file):
        return BuildReducedModel(Input=boundary, ActiveNodes=[node_at(boundary, CORNER)],
                                 Reach=0.01, Modes=4, TrainingPaths=1, PathDuration=0.04,
                                 TestPaths=0, FileName=file)

    check_bodies(reduced, "reduced.palpate")


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            delete_all()
            print(name, "passed", flush=True)
