# SPDX-License-Identifier: BSD-3-Clause
"""What a solve cost, and a run."""
import ctypes
import time

import numpy as np
from paraview import servermanager
from paraview.simple import *

from pipeline import field, output, update
from sources import programmed


class Measured:
    """An equilibrium: its data set (until the next one), figures, seconds and memory."""

    def __init__(self, scene, displacement, **settings):
        """displacement: m; settings: of Solve Equilibrium."""
        solve = SolveEquilibrium(Input=scene, Displacement=[float(x) for x in displacement],
                                 **settings)
        before = Memory()
        start = time.process_time()
        self.grid = output(update(solve))
        # Of the processor: what else the machine does has no part in it.
        self.seconds = time.process_time() - start
        self.megabytes = before.growth()
        self.solve = solve

    def figure(self, name):
        values = field(self.grid, name)
        return None if values is None else values[0]

    @property
    def force(self):
        return np.array(field(self.grid, "ReactionForce"))

    def forget(self):
        Delete(self.solve)
        self.grid = self.solve = None


class Memory:
    """How far this process grows at the most, MB; None where the system does not tell."""

    def __init__(self):
        try:
            ctypes.CDLL(None).malloc_trim(0)  # what was given back before does not count
            with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
                file.write("5")  # the largest size begins anew
            self.start = self.of("VmRSS")
        except (OSError, AttributeError):
            self.start = None

    @staticmethod
    def of(name):
        with open("/proc/self/status", encoding="ascii") as file:
            line = next(line for line in file if line.startswith(name + ":"))
        return int(line.split()[1]) / 1024

    def growth(self):
        return None if self.start is None else self.of("VmHWM") - self.start


PEAK = """
import resource
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkPoints
points, array = vtkPoints(), vtkDoubleArray()
points.InsertNextPoint(0, 0, 0)
array.SetName("MB")
array.InsertNextValue(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
self.GetPolyDataOutput().SetPoints(points)
self.GetPolyDataOutput().GetPointData().AddArray(array)
"""


def peak_memory():
    """The most that each rank has had so far, MB."""
    # Points, of which Fetch appends those of the other ranks.
    source = programmed("vtkPolyData", PEAK)
    array = servermanager.Fetch(source).GetPointData().GetArray("MB")
    Delete(source)
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())]
