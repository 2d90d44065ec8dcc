# SPDX-License-Identifier: BSD-3-Clause
"""BuildReducedModel and SimulateTouch: the small model of a body is right beside the whole body, in
the same motion, for one tool and for two."""

import time

import numpy
from paraview import servermanager
from paraview.simple import (AssignMaterial, BuildReducedModel, CSVReader,
                             PrecomputeStateSpace, SetBoundary, SimulateTouch, SolveDynamics,
                             SolveEquilibrium, TouchReducedModel)
from support import Messages, box_body, expect_error, fetch, field, node_at, point_array, source
from vtkmodules.util.numpy_support import vtk_to_numpy

DENSITY = 1000.0
LENGTH, WIDTH = 0.2, 0.1
REACH = 0.01
CONVERGED, _, BEYOND_TRAINING = range(3)
# Fewer modes than the default, so that the test is short.
TRAINING = {"TrainingPaths": 4, "Modes": 40}


def held(**material):
    """A box held at x = 0."""
    body = source(box_body((4, 2, 2), (LENGTH, WIDTH, WIDTH)), "box")
    material = {"Law": "Neo-Hookean", "YoungsModulus": 5000, "PoissonsRatio": 0.4,
                "Density": DENSITY} | material
    boundary = SetBoundary(Input=AssignMaterial(Input=body, **material), FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    return boundary


def corners(boundary):
    return [node_at(boundary, [LENGTH, y, WIDTH]) for y in (0, WIDTH)]


def table_of(name, times, *tools, **held):
    """@param held Columns that say when a tool is held, by name."""
    columns = ["Time"] + [f"Tool{tool}_{axis}" for tool in range(len(tools)) for axis in "XYZ"]
    columns += list(held)
    rows = numpy.column_stack([times, *(numpy.asarray(tool) for tool in tools), *held.values()])
    numpy.savetxt(name + ".csv", rows, delimiter=",", header=",".join(columns), comments="")
    return CSVReader(FileName=[name + ".csv"])


def columns_of(filter_, port):
    filter_.UpdatePipeline()
    table = servermanager.Fetch(filter_, idx=port)
    arrays = {}
    for i in range(table.GetNumberOfColumns()):
        array = table.GetColumn(i)
        arrays[table.GetColumnName(i)] = (
            [array.GetValue(k) for k in range(array.GetNumberOfValues())]
            if array.IsA("vtkStringArray") else vtk_to_numpy(array))
    return arrays


# A pull to one side and back, then a wait.
TIMES = [0, 0.1, 0.2, 0.3, 0.5]
PULL = REACH * numpy.array([[0, 0, 0], [0.3, 0.2, 0.5], [0.2, -0.4, 0.6], [0, 0, 0], [0, 0, 0]])


def test_one_tool_moves_as_the_whole_body_does():
    boundary = held(ViscousTime=0.01)
    node = corners(boundary)[0]
    model = BuildReducedModel(Input=boundary, ActiveNodes=[node], TipRadius=0.03, Reach=REACH,
                              **TRAINING)
    errors = columns_of(model, 1)
    assert errors["Case"] == ["One tool at rest", "Motion"]
    assert (errors["Failed"] == 0).all() and (errors["Compared"] > 0).all()
    assert errors["MaximumError"][0] < 0.002 and errors["RmsError"][1] < 0.008, errors
    assert (errors["Modes"] == TRAINING["Modes"]).all()
    assert 0 < errors["MedianStep"][1] < errors["WholeStep"][1]

    paths = table_of("pull", TIMES, PULL)
    common = {"ToolPaths": paths, "EndTime": 0.5, "FrameRate": 20}
    touch = SimulateTouch(Input=model, **common)
    whole = SolveDynamics(Input=boundary, ActiveNodes=[node], TipRadius=0.03, **common)
    of_touch, of_whole = columns_of(touch, 1), columns_of(whole, 1)
    assert (of_touch["Outcome"] == CONVERGED).all()
    assert of_touch["Trust"].max() < 2, of_touch["Trust"]
    numpy.testing.assert_allclose(of_touch["Time"], of_whole["Time"], atol=1e-12)
    largest = numpy.linalg.norm(of_whole["Force0"], axis=1).max()
    error = numpy.linalg.norm(of_touch["Force0"] - of_whole["Force0"], axis=1).max()
    assert error < 0.01 * largest, error / largest

    # It says how far it is, and an abort keeps what there is.
    shortened = SimulateTouch(Input=model, **common)
    algorithm = shortened.GetClientSideObject()
    observer = algorithm.AddObserver("ProgressEvent", lambda *_: algorithm.SetAbortExecute(1))
    with Messages() as messages:
        of_shortened = columns_of(shortened, 1)
    assert messages.warnings == 1 and "Aborted at" in messages.text, messages.text
    assert of_shortened["Time"][-1] < 0.5
    assert field(servermanager.Fetch(shortened), "Complete")[0] == 0
    algorithm.RemoveObserver(observer)
    shortened.EndTime = 0.4
    assert columns_of(shortened, 1)["Time"][-1] == 0.4
    assert field(servermanager.Fetch(shortened), "Complete")[0] == 1

    # The animation: the same shape at each time, in any order.
    touch.UpdatePipelineInformation()
    times = list(touch.TimestepValues)
    assert len(times) == 11 and times[-1] == 0.5
    for time in (times[6], times[2], times[10]):
        touch.UpdatePipeline(time)
        whole.UpdatePipeline(time)
        shapes = [point_array(servermanager.Fetch(filter_), "Displacement")
                  for filter_ in (touch, whole)]
        assert abs(shapes[0] - shapes[1]).max() < 0.02 * REACH
        body = servermanager.Fetch(touch)
        assert field(body, "Time")[0] == time and field(body, "Outcome")[0] == CONVERGED
        assert numpy.size(field(body, "ReactionForce")) == 3


def test_gravity():
    """The body sags first; from there its model moves as the whole body does under its weight, and
    swings under it when its tool lets go."""
    boundary = held(ViscousTime=0.01)
    node = corners(boundary)[0]
    common = {"ActiveNodes": [node], "TipRadius": 0.03, "BodyForce": [0, 0, -2]}
    model = BuildReducedModel(Input=boundary, Reach=REACH, TestPaths=0, PathDuration=1, **common,
                              **TRAINING)
    motion = {"ToolPaths": table_of("heavy", TIMES, PULL, Tool0_Held=[1, 1, 1, 1, 0]),
              "EndTime": 0.7, "FrameRate": 20}
    touch = SimulateTouch(Input=model, **motion)
    whole = SolveDynamics(Input=boundary, **common, **motion)
    of_touch, of_whole = columns_of(touch, 1), columns_of(whole, 1)
    assert (of_touch["Outcome"] == CONVERGED).all()
    assert (of_touch["Force0"][0] == 0).all() and of_touch["ElasticEnergy"][0] == 0
    largest = numpy.linalg.norm(of_whole["Force0"], axis=1).max()
    error = numpy.linalg.norm(of_touch["Force0"] - of_whole["Force0"], axis=1).max()
    assert error < 0.01 * largest, error / largest
    energy = of_whole["ElasticEnergy"] + of_whole["WeightEnergy"]
    error = abs(of_touch["ElasticEnergy"] - energy + energy[0])[of_touch["Time"] < 0.5]
    assert error.max() < 0.01 * (energy.max() - energy[0])
    touch.UpdatePipelineInformation()
    # The patch of a tool that was let go stays rigid in the model, with gravity or without.
    for frame, bound in ((0, 1e-6), (4, 0.02), (10, 0.02), (14, 0.2)):
        shapes = []
        for filter_ in (touch, whole):
            filter_.UpdatePipeline(touch.TimestepValues[frame])
            shapes.append(point_array(servermanager.Fetch(filter_), "Displacement"))
        assert abs(shapes[0] - shapes[1]).max() < bound * REACH, frame
        # It sags by half of its length.
        assert shapes[0][:, 2].min() < -0.4 * LENGTH
    # So it is drawn at rest where hands are to move it.
    assert fetch(TouchReducedModel(Input=model)).GetBounds()[4] < -0.4 * LENGTH

    weightless = held(Density=0)
    for filter_ in (BuildReducedModel(Input=weightless, **common),
                    SolveEquilibrium(Input=weightless, **common)):
        expect_error(filter_.UpdatePipeline, "There is a BodyForce, but the body has no density")
    expect_error(BuildReducedModel(Input=boundary, **common | {"BodyForce": [0, 0, float("nan")]})
                 .UpdatePipeline, "BodyForce")


def test_two_tools_at_rest():
    """Without density there is no inertia, and nothing is trained in motion."""
    boundary = held(Density=0)
    nodes = corners(boundary)
    model = BuildReducedModel(Input=boundary, ActiveNodes=nodes, TipRadius=0.02, Reach=REACH,
                              Modes=30)
    errors = columns_of(model, 1)
    assert errors["Case"] == ["One tool at rest", "All tools at rest"]
    assert errors["MaximumError"].max() < 0.02, errors
    # Far beyond what it was made for it says so.
    far = table_of("far", [0, 1], [[0, 0, 0], [0, 0, 0.1]], numpy.zeros((2, 3)))
    touch = columns_of(SimulateTouch(Input=model, ToolPaths=far), 1)
    assert touch["Trust"].max() > 2 and numpy.isfinite(touch["Force0"]).all()
    assert BEYOND_TRAINING in touch["Outcome"]


def test_the_same_seed_gives_the_same_model():
    boundary = held(Density=0)
    nodes = corners(boundary)[:1]
    gradients = []
    for seed in (3, 3, 4):
        model = BuildReducedModel(Input=boundary, ActiveNodes=nodes, TipRadius=0.02, Modes=20,
                                  Seed=seed)
        gradients.append(field(fetch(model), "ReducedPointGradients"))
    assert numpy.array_equal(gradients[0], gradients[1])
    assert not numpy.array_equal(gradients[0], gradients[2])


def test_let_go():
    """Two tools pull a corner each; one lets go, and then the other: the body swings as the whole
    one does, and the tools that were let go swing with it, without a force."""
    boundary = held()
    nodes = corners(boundary)
    common = {"ActiveNodes": nodes, "TipRadius": 0.02}
    model = BuildReducedModel(Input=boundary, Reach=REACH, TestPaths=0, **common, **TRAINING)
    pull = REACH * numpy.array([[0, 0, 0], [0, 0.1, 0.6], [0, 0.1, 0.6], [0, 0, 0]])
    times = [0, 0.1, 0.2, 0.3]
    paths = table_of("go", times, pull, 0.5 * pull, Tool0_Held=[1, 1, 0, 0],
                     Tool1_Held=[1, 1, 1, 0])
    motion = {"ToolPaths": paths, "EndTime": 1.0, "TimeStep": 0.004}
    touch = columns_of(SimulateTouch(Input=model, **motion), 1)
    whole = columns_of(SolveDynamics(Input=boundary, **common, **motion), 1)
    assert (touch["Outcome"] == CONVERGED).all()
    for history in (touch, whole):
        time = history["Time"]
        # A step ends where a tool is let go.
        assert all(abs(time - release).min() < 1e-12 for release in (0.2, 0.3)), time
        for tool, release in ((0, 0.2), (1, 0.3)):
            force = numpy.linalg.norm(history[f"Force{tool}"], axis=1)
            assert (force[time > release + 1e-9] == 0).all() and force[time < release].max() > 0.01
        swing = history["Position0"][time > 0.2, 2]
        assert swing.min() < -0.2 * REACH and abs(swing).max() < REACH, (swing.min(), swing.max())
    off = max(numpy.interp(t, whole["Time"], whole["Position0"][:, 2]) - z
              for t, z in zip(touch["Time"], touch["Position0"][:, 2]))
    assert abs(off) < 0.1 * REACH, off

    for flags, words in (([1, 0, 1, 1], ["Tool0_Held", "Row 2", "not 0 after a 0"]),
                         ([1, 2, 0, 0], ["Tool0_Held", "Row 1", "neither 0 nor 1"])):
        bad = table_of("bad", times, pull, pull, Tool0_Held=flags)
        for filter_ in (SimulateTouch(Input=model, ToolPaths=bad),
                        SolveDynamics(Input=boundary, ToolPaths=bad, **common)):
            expect_error(filter_.UpdatePipeline, *words)


def test_a_file_keeps_the_model():
    """It is read as it was built, together with its errors, also beside a state space."""
    boundary = held()
    node = corners(boundary)[0]
    settings = {"ActiveNodes": [node], "TipRadius": 0.03, "Modes": 12, "TrainingPaths": 2,
                "PathDuration": 0.1}
    models, errors, seconds = [], [], []
    for file in ("", "model.palpate", "model.palpate"):
        model = BuildReducedModel(Input=boundary, FileName=file, **settings)
        start = time.monotonic()
        model.UpdatePipeline()
        seconds.append(time.monotonic() - start)
        errors.append(columns_of(model, 1))
        data = fetch(model)
        models.append([field(data, "ReducedPointGradients"), field(data, "ReducedMass"),
                       point_array(data, "ReducedBasis")])
    for model, of_model in zip(models, errors):
        assert all(numpy.array_equal(a, b) for a, b in zip(model, models[0]))
        for column in ("Case", "Compared", "MaximumError", "RmsError", "Points"):
            assert numpy.array_equal(of_model[column], errors[0][column]), column
    # What is measured with a clock tells that the last one was read.
    assert numpy.array_equal(errors[2]["WholeStep"], errors[1]["WholeStep"])
    assert seconds[2] < seconds[1] / 2, seconds

    space = PrecomputeStateSpace(Input=boundary, ActiveNodes=[node], TipRadius=0.03,
                                 HalfWidth=0.002, Resolution=3, FileName="model.palpate")
    space.UpdatePipeline()
    space.UpdatePropertyInformation()
    assert space.GetProperty("ErrorCode").GetData() == 0
    other = held(YoungsModulus=6000)
    expect_error(BuildReducedModel(Input=other, FileName="model.palpate",
                                   **settings).UpdatePipeline, "another scene")
    expect_error(BuildReducedModel(Input=boundary, FileName="no_folder/a.palpate",
                                   **settings).UpdatePipeline, "no folder")


def texts_of_update(model):
    """What the filter tells of its progress."""
    texts = []
    algorithm = model.GetClientSideObject()
    observer = algorithm.AddObserver("ProgressEvent",
                                     lambda *_: texts.append(algorithm.GetProgressText()))
    model.UpdatePipeline()
    algorithm.RemoveObserver(observer)
    return {text for text in texts if text}


def test_tools_attach_away_from_their_training():
    """Trained with the tool at some places, the body follows it at others as the whole one does;
    the tool that moves takes no training, with a file or without."""
    boundary = held(ViscousTime=0.01)
    places = [node_at(boundary, [LENGTH, y, WIDTH]) for y in (0, WIDTH)]
    nodes = [node_at(boundary, [x, WIDTH / 2, WIDTH]) for x in (LENGTH, 0.75 * LENGTH)]
    settings = {"TrainingPlaces": places, "TipRadius": 0.03, "Reach": REACH, "TrainingPaths": 2,
                "PathDuration": 0.5, "Modes": 60}
    gradients = {}
    for file, test_paths in (("", 0), ("places.palpate", 1)):
        model = BuildReducedModel(Input=boundary, FileName=file, ActiveNodes=nodes[:1],
                                  TestPaths=test_paths, **settings)
        assert any("place 2 of 2" in text for text in texts_of_update(model))
        model.ActiveNodes = nodes[1:]
        texts = texts_of_update(model)
        assert texts and not any("place" in text for text in texts), texts
        gradients[file] = field(fetch(model), "ReducedPointGradients")
    errors = columns_of(model, 1)
    assert errors["Case"] == ["One tool at rest between places", "Motion between places"]
    assert (errors["Failed"] == 0).all() and (errors["Compared"] > 0).all()
    assert errors["MaximumError"][0] < 0.01 and errors["RmsError"][1] < 0.008, errors
    assert numpy.array_equal(gradients[""], gradients["places.palpate"])
    # Another filter takes the training from the file.
    model = BuildReducedModel(Input=boundary, FileName=file, ActiveNodes=places[:1],
                              TestPaths=0, **settings)
    assert not any("place" in text for text in texts_of_update(model))

    model.ActiveNodes = nodes[1:]
    common = {"ToolPaths": table_of("between", TIMES, PULL), "EndTime": 0.3}
    touch = columns_of(SimulateTouch(Input=model, **common), 1)
    whole = columns_of(SolveDynamics(Input=boundary, ActiveNodes=nodes[1:], TipRadius=0.03,
                                     **common), 1)
    assert (touch["Outcome"] == CONVERGED).all()
    largest = numpy.linalg.norm(whole["Force0"], axis=1).max()
    error = numpy.linalg.norm(touch["Force0"] - whole["Force0"], axis=1).max()
    assert error < 0.02 * largest, error / largest


def test_two_tools_attach_away_from_their_training():
    """A place is a point for each tool, in their order."""
    boundary = held(Density=0)
    top, bottom = ([node_at(boundary, [x, WIDTH / 2, z]) for x in (LENGTH, 0.75 * LENGTH)]
                   for z in (WIDTH, 0))
    model = BuildReducedModel(Input=boundary, TrainingPlaces=[top[0], bottom[0], top[1], bottom[1]],
                              ActiveNodes=[top[0], bottom[1]], TipRadius=0.02, Reach=REACH,
                              Modes=60)
    errors = columns_of(model, 1)
    assert errors["Case"] == ["One tool at rest between places",
                              "All tools at rest between places"]
    assert errors["MaximumError"].max() < 0.02, errors


def test_bad_training_places():
    boundary = held(Density=0)
    nodes = corners(boundary)
    fixed = node_at(boundary, [0, WIDTH, WIDTH])
    inside = node_at(boundary, [LENGTH / 2, WIDTH / 2, WIDTH / 2])
    for settings, words in (({"ActiveNodes": []}, ["needs a tool"]),
                            ({"TrainingPlaces": [10**6]}, ["Training place 1000000", "exist"]),
                            ({"TrainingPlaces": [-1]}, ["Training place -1", "exist"]),
                            ({"TrainingPlaces": [fixed]}, [f"Training place {fixed}", "is fixed"]),
                            ({"TrainingPlaces": [inside]}, [f"{inside}", "inside the body"]),
                            ({"ActiveNodes": [fixed]}, [f"Active node {fixed}", "is fixed"]),
                            ({"TrainingPlaces": [*nodes, nodes[0]]}, ["the same as one before"]),
                            ({"ActiveNodes": nodes, "TrainingPlaces": nodes[:1]},
                             ["length of 1", "active nodes, 2"]),
                            ({"ActiveNodes": nodes, "TrainingPlaces": [nodes[0]] * 2},
                             [f"Training place {nodes[0]} is named twice"])):
        model = BuildReducedModel(Input=boundary, **{"ActiveNodes": nodes[:1],
                                                     "TrainingPlaces": nodes} | settings)
        expect_error(model.UpdatePipeline, *words)
    near = [node_at(boundary, [LENGTH, WIDTH / 2, WIDTH]), nodes[0]]
    expect_error(BuildReducedModel(Input=boundary, ActiveNodes=nodes, TrainingPlaces=near,
                                   TipRadius=0.03).UpdatePipeline,
                 "The tips at the training places", "share point")
    mixed = held(PoissonsRatio=0.49)
    expect_error(BuildReducedModel(Input=mixed, ActiveNodes=nodes[:1],
                                   TrainingPlaces=nodes).UpdatePipeline, "pressure of its own")


def test_bad_input():
    boundary = held(Density=0)
    nodes = corners(boundary)
    for settings, words in (({"ActiveNodes": []}, ["needs a tool"]),
                            ({"ActiveNodes": [10**6]}, ["1000000"]),
                            ({"ActiveNodes": nodes, "TipRadius": 0.09}, ["share"]),
                            ({"Modes": 0}, ["Modes"]),
                            ({"Tolerance": 1}, ["Tolerance"]),
                            ({"Reach": 0}, ["Reach"]),
                            ({"Seed": -1}, ["Seed"]),
                            ({"TestPaths": -1}, ["TestPaths"])):
        model = BuildReducedModel(Input=boundary, **{"ActiveNodes": nodes[:1]} | settings)
        expect_error(model.UpdatePipeline, *words)
    mixed = held(PoissonsRatio=0.49)
    expect_error(BuildReducedModel(Input=mixed, ActiveNodes=nodes[:1]).UpdatePipeline,
                 "pressure of its own")

    paths = table_of("two", [0, 1], numpy.zeros((2, 3)), numpy.zeros((2, 3)))
    expect_error(SimulateTouch(Input=boundary, ToolPaths=paths).UpdatePipeline,
                 "has no reduced model", "Build Reduced Model")
    model = BuildReducedModel(Input=boundary, ActiveNodes=nodes[:1], TipRadius=0.02, Modes=10)
    expect_error(SimulateTouch(Input=model, ToolPaths=paths).UpdatePipeline, "2 tools")
    one = table_of("one", [0, 1], numpy.zeros((2, 3)))
    for settings in ({"EndTime": 0}, {"FrameRate": -1}, {"TimeStep": 1e-12}):
        expect_error(SimulateTouch(Input=model, ToolPaths=one, **settings).UpdatePipeline,
                     *settings)


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(name, "passed", flush=True)
