# SPDX-License-Identifier: BSD-3-Clause
"""TetrahedralizeSurface on several ranks: the pieces of a surface that each rank holds are meshed
as one, and a bad surface is an error on no rank's wait."""

import math

from paraview import servermanager
from paraview.modules.vtkRemotingCore import vtkProcessModule
from paraview.simple import Sphere, TetrahedralizeSurface

ranks = vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions()
assert ranks > 1, "to be run under mpiexec"

# Sphere gives each rank a piece.
sphere = Sphere(ThetaResolution=24, PhiResolution=24)
body = TetrahedralizeSurface(Input=sphere, ElementOrder="Quadratic")
body.UpdatePipeline()
information = body.GetDataInformation()
assert information.GetNumberOfCells() > 1000
whole = servermanager.Fetch(body)
assert whole.GetNumberOfCells() == information.GetNumberOfCells()
bounds = whole.GetBounds()
assert all(abs(abs(bound) - 0.5) < 0.01 for bound in bounds), bounds

sphere.EndTheta = 270.0
body.UpdatePipeline()
assert body.GetDataInformation().GetNumberOfCells() == 0
assert servermanager.Fetch(body, idx=1).GetNumberOfLines() > 0

body.RepairSurface = 1
body.UpdatePipeline()
assert body.GetDataInformation().GetNumberOfCells() > 1000
