# SPDX-License-Identifier: BSD-3-Clause
"""Every example that ParaView's window can show has a script, a page with a picture and a state;
and each state opens without an error and draws something. (That of the liver: test_gui.py.)"""

import os
import re
import tempfile

import numpy as np
from image_support import share_drawn
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

EXAMPLES = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "examples")
LARGEST_STATE = 100_000  # bytes
# Where the data of a state is, if it is not that of the liver. That of the brain is made of maps
# that are fetched, and an egg takes its place here.
DATA = {"roof": os.path.join(EXAMPLES, "roof"), "nodule": os.path.join(EXAMPLES, "nodule"),
        "bed": os.path.join(EXAMPLES, "bed"), "brain": os.path.abspath("egg")}
VOXEL = 8.0  # mm
# Of the spaces of a rigid tool, which take longest, the radius of the part of the surface that they
# are of: smaller than in the state, and the tool of the state still presses it. m
REGION = {"brain": 0.004, "nodule": 0.003, "palpation": 0.006}
EDGE = 0.05  # of the tetrahedra of the egg, m
# Of the check-points of the egg, m: its large facets are felt one by one, and with the state's
# spacing its cells are marked.
SPACING = 0.006
# What divides the body of such a state into tetrahedra, which take less time if they are linear.
DIVIDES = {"brain": "TetrahedralizeLabelMap", "nodule": "TetrahedralizeSurface",
           "palpation": "TetrahedralizeSurface"}
# Of the paths on which a reduced model is trained, s.
PATH_DURATION = 0.2
# Of a lobe that tears, m.
PULL = 0.003
# Points at which the accuracy of a space is measured.
TEST_POINTS = 8
INSIDE = 1


def errors_of(action):
    """What is written to the terminal as an error meanwhile."""
    with tempfile.TemporaryFile("w+") as file:
        terminal = os.dup(2)
        os.dup2(file.fileno(), 2)
        try:
            action()
        finally:
            os.dup2(terminal, 2)
            os.close(terminal)
        file.seek(0)
        return [line for line in file if "ERR|" in line]


def filter_of(kind):
    """The one source of that name."""
    found, = (proxy for proxy in GetSources().values() if proxy.GetXMLName() == kind)
    return found


def make_smaller(name):
    """The filters of a state compute when it is drawn, and not before."""
    if name in REGION:
        filter_of("PrecomputeStateSpace").ToolRegion.Radius = REGION[name]
        filter_of(DIVIDES[name]).ElementOrder = "Linear"
    if name == "brain":
        filter_of("TetrahedralizeLabelMap").ElementSize = EDGE
        filter_of("PrecomputeStateSpace").Spacing = SPACING
    if name in ("two_hands", "wobble"):
        filter_of("BuildReducedModel").PathDuration = PATH_DURATION
    if name == "tear":
        filter_of("PrecomputeStateSpace").HalfWidth = PULL
        filter_of("TouchStateSpace").Displacement = [0, -PULL, 0]
    if name == "accuracy":
        filter_of("AccuracyReport").TestPoints = TEST_POINTS


def open_state(name):
    def load():
        data = DATA.get(name, os.path.join(EXAMPLES, "liver"))
        LoadState(os.path.join(EXAMPLES, name, name + ".pvsm"), data_directory=data)
        make_smaller(name)
        SaveScreenshot(name + ".png", GetActiveView(), ImageResolution=[400, 300])

    errors = errors_of(load)
    assert not errors, (name, errors)
    assert 0.005 < share_drawn(name + ".png") < 0.8, (name, share_drawn(name + ".png"))
    if name in REGION:
        found = filter_of("TouchStateSpace").FieldData["Found"].GetRange(0)
        assert found == (INSIDE, INSIDE), (name, found)


def check_the_triple(name):
    folder = os.path.join(EXAMPLES, name)
    assert any(entry.endswith(".py") for entry in os.listdir(folder)), name
    with open(os.path.join(folder, "README.md"), encoding="utf-8") as file:
        page = file.read()
    assert re.search(r"!\[[^\]]+\]\([^)]+\.png\)", page), f"{name}: the page has no picture"
    assert f"{name}.pvsm" in page, f"{name}: the page does not name the state"
    state = os.path.join(folder, name + ".pvsm")
    assert os.path.getsize(state) < LARGEST_STATE, state
    with open(state, encoding="utf-8") as file:
        assert EXAMPLES not in file.read(), state


def check_that_the_past_does_not_count():
    """A body that snaps, at the same displacements in whatever order: the branch depends on where
    the node is said to come from."""
    touch = FindSource("Touch")
    deflections = [0.0025 * i for i in range(13)]

    def branches(start, order):
        touch.StartDisplacement = [0, 0, -start]
        found = {}
        for deflection in order:
            touch.Displacement = [0, 0, -deflection]
            touch.UpdatePipeline()
            found[deflection] = touch.FieldData["Branch"].GetRange(0)[0]
        return [found[deflection] for deflection in deflections]

    down, up = (branches(start, deflections) for start in (0, 0.03))
    assert down != up and down[0] == up[0] == 0, (down, up)
    assert down == branches(0, deflections[::-1]) and up == branches(0.03, deflections[::-1])
    # The branch of the start may be said, too.
    between = next(d for d, a, b in zip(deflections, down, up) if a != b)
    touch.StartDisplacement = [0, 0, -between]
    touch.Displacement = [0, 0, -between]
    for branch in (0, 1):
        touch.StartBranch = branch
        touch.UpdatePipeline()
        assert touch.FieldData["Branch"].GetRange(0)[0] == branch
    touch.StartBranch = 7
    assert errors_of(touch.UpdatePipeline)


def check_the_old_name(name):
    """A state of a version in which the list of active nodes had another name."""
    with open(os.path.join(EXAMPLES, name, name + ".pvsm"), encoding="utf-8") as file:
        old = re.search(r'<Property name="ActiveNode" .*?<Element index="0" value="(\d+)"',
                        file.read(), re.DOTALL)
    assert old and old.group(1) != "0"
    nodes = [list(proxy.ActiveNodes) for proxy in GetSources().values()
             if proxy.GetXMLName() == "SolveEquilibrium"]
    assert nodes and all(ids == [int(old.group(1))] for ids in nodes), (nodes, old.group(1))


def save_egg():
    """Labels of an egg of grey matter with white matter in it, whose surface goes through the place
    at which the state of the brain presses."""
    touched = np.array((-36.0, 33.0, 68.0))  # mm; FRONT of examples/brain/organ.py
    centre, half_axes = np.array((0.0, -17.0, 8.0)), np.array((70.0, 88.0, 72.0))  # mm
    half_axes *= np.linalg.norm((touched - centre) / half_axes)
    corner = centre - half_axes - VOXEL
    numbers = np.ceil(2 * (half_axes + VOXEL) / VOXEL).astype(int) + 1
    axes = np.meshgrid(*map(np.arange, numbers), indexing="ij")
    places = corner + VOXEL * np.stack(axes, axis=-1)
    away = np.linalg.norm((places - centre) / half_axes, axis=-1)
    labels = np.select([away < 0.6, away < 1], [2, 1], 0).astype(np.uint8)
    image = vtkImageData()
    image.SetDimensions(labels.shape)
    image.SetSpacing(VOXEL, VOXEL, VOXEL)
    image.SetOrigin(corner)
    array = numpy_to_vtk(labels.ravel(order="F"), deep=True)
    array.SetName("Label")
    image.GetPointData().SetScalars(array)
    os.makedirs(DATA["brain"], exist_ok=True)
    writer = vtkXMLImageDataWriter()
    writer.SetFileName(os.path.join(DATA["brain"], "labels.vti"))
    writer.SetDataModeToBinary()
    writer.SetInputData(image)
    writer.Write()


save_egg()
names = sorted(name for name in os.listdir(EXAMPLES)
               if os.path.isfile(os.path.join(EXAMPLES, name, "README.md")))
assert len(names) == 16, names
for name in names:
    if name != "embedding":
        check_the_triple(name)
    if name not in ("embedding", "liver"):
        open_state(name)
        if name in ("discretisation", "stability"):
            check_the_old_name(name)
        if name == "roof":
            check_that_the_past_does_not_count()
        Disconnect()
        Connect()
