# SPDX-License-Identifier: BSD-3-Clause
"""The road of reduced models in the two ways to run ParaView in which ranks and scripts are not as
in pvbatch: each rank runs the script (pvbatch --symmetric), and a client is connected to a server.

  test_reduced_ways.py [server <command>…]

where the command starts pvserver; without it the script runs on each rank.
"""

import os
import subprocess
import sys
import traceback

import numpy
from paraview import servermanager
from paraview.simple import (AssignMaterial, BuildReducedModel, Connect, CSVReader, SetBoundary,
                             SimulateTouch, SolveDynamics, TouchReducedModel)
from support import Messages, box_body, field, places, point_array, source
from test_interactor import HOST, served

LIFT = 0.005  # m
USER_ERROR = 40000


def rank():
    return servermanager.vtkProcessModule.GetProcessModule().GetPartitionId()


def node_at(place):
    """Without the data of the pipeline, which not every rank has."""
    return int(numpy.linalg.norm(places(box_body()) - place, axis=1).argmin())


def update(proxy, time=None):
    """The error code, the same on every rank."""
    proxy.UpdatePipeline(*([] if time is None else [time]))
    proxy.UpdatePropertyInformation()
    return proxy.GetPropertyValue("ErrorCode")


def test_road():
    own = f"rank{rank()}"
    body = source(box_body(), own)
    material = AssignMaterial(Input=body, Law="Neo-Hookean", YoungsModulus=5000,
                              PoissonsRatio=0.4, Density=1000, ViscousTime=0.01)
    boundary = SetBoundary(Input=material, FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    nodes = [node_at([0.2, y, 0.1]) for y in (0, 0.05, 0.1)]
    common = {"TipRadius": 0.03}
    training = {"TrainingPaths": 2, "TestPaths": 0, "PathDuration": 0.5, "Modes": 60, **common}
    with open(own + ".csv", "w", encoding="ascii") as file:
        file.write(f"Time,Tool0_X,Tool0_Y,Tool0_Z\n0,0,0,0\n0.1,0,0,{LIFT}\n0.2,0,0,0\n")
    motion = {"ToolPaths": CSVReader(FileName=[own + ".csv"]), "EndTime": 0.1}
    whole = SolveDynamics(Input=boundary, ActiveNodes=nodes[1:2], **common, **motion)
    assert update(whole, 0.1) == 0
    whole_force = last_force(whole)
    # Trained where the tool is, and with places of training, from which the tool is then moved.
    for settings in ({"ActiveNodes": nodes[1:2]},
                     {"ActiveNodes": nodes[:1], "TrainingPlaces": [nodes[0], nodes[2]]}):
        model = BuildReducedModel(Input=boundary, **settings, **training)
        touch = SimulateTouch(Input=model, **motion)
        assert update(model) == 0 and update(touch, 0.05) == 0
        model.ActiveNodes = nodes[1:2]
        assert update(touch, 0.1) == 0 and update(model) == 0
        assert update(TouchReducedModel(Input=model)) == 0
        force = last_force(touch)
        if force is not None:
            error = numpy.linalg.norm(force - whole_force) / numpy.linalg.norm(whole_force)
            assert error < 0.05, (settings, error)

    wrong = BuildReducedModel(Input=boundary, ActiveNodes=nodes[:1], TrainingPlaces=[10**6],
                              **training)
    with Messages() as messages:
        assert update(wrong) == USER_ERROR
    assert messages.text.count("Training place 1000000 does not exist") == (rank() == 0)


def last_force(filter_):
    """The one that is told; None on a rank that has not the data."""
    body = servermanager.Fetch(filter_)
    if rank() != 0:
        assert not body or body.GetNumberOfPoints() == 0
        return None
    assert abs(point_array(body, "Displacement")[:, 2].max() / LIFT - 1) < 0.1
    return field(body, "ReactionForce").ravel()


def main():
    what, *arguments = sys.argv[1:] or ["on each rank"]
    if what == "server":
        with served(arguments) as (port, _):
            pvpython = os.readlink("/proc/self/exe")
            subprocess.run([pvpython, __file__, "client", str(port)], check=True)
        return
    if what == "client":
        Connect(HOST, int(arguments[0]))
        assert servermanager.ActiveConnection.GetNumberOfDataPartitions() == 2
    test_road()
    print("test_road passed", flush=True)


if __name__ == "__main__":
    try:
        main()
    except Exception:  # pylint: disable=broad-except
        # mpiexec ends the other ranks, which would wait for this one.
        traceback.print_exc()
        os._exit(1)
