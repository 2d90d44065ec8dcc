# SPDX-License-Identifier: BSD-3-Clause
"""The surfaces of a liver, of a stomach beside it and of a soft bed that fits under both, made from
implicit functions as in ../liver/make_surface.py. The patient lies on the back: y points to the
head, z to the front, which is up."""
import numpy as np
from vtkmodules.vtkFiltersCore import vtkAppendPolyData

from bodies import Organ, add_cell_array
from make_surface import common, contour, ellipsoid, half_space, liver, make_surface, without

LIVER, BED, STOMACH = range(3)  # their numbers in the cell array Region
TOUCHED = (-0.04, 0.03, 0.08)  # the point of the liver that is nearest to it, m
# Between the parts at rest, times the square of an edge: more than such an edge cuts off a hollow.
# 1/m
GAP = 15
EDGES_OF_BED = 1.2  # how much longer they are
ROUND = 0.012  # radius of the bed's edges, m
BED_LOW, BED_HIGH = np.array([[-0.13, -0.135, -0.115], [0.15, 0.105, -0.03]])  # corners, m
# The hollow that the liver has for the stomach, which fills it: centre, half-axes, m.
HOLLOW = np.array([[0.066, -0.050, -0.040], [0.070, 0.070, 0.078]])
STOMACH_BACK, ROUND_BACK = -0.072, 0.03  # how far back it reaches, and how round it is there, m
MARGIN = 0.012  # around what is sampled, m


def stomach(points, gap):
    return common(ellipsoid(points, *HOLLOW) + gap,
                  half_space(points, (0, 0, STOMACH_BACK), (0, 0, -1)), ROUND_BACK)


def bed(points, gap):
    """A block with round edges, and with hollows in which the liver and the stomach lie."""
    away = np.abs(points - (BED_LOW + BED_HIGH) / 2) - ((BED_HIGH - BED_LOW) / 2 - ROUND)
    block = np.linalg.norm(np.maximum(away, 0), axis=1) + np.minimum(away.max(axis=1), 0) - ROUND
    return without(without(block, liver(points) - gap, ROUND), stomach(points, gap) - gap, ROUND)


def largest(function, low, high, edge):
    """Of the closed surfaces on which function(points) is 0 in a box, m."""
    return contour(function, low - MARGIN, high + MARGIN, edge, only_largest=True)


def make_surfaces(edge, tip_radius):
    """The liver with shorter edges where a sphere of that radius touches it, and a vtkPolyData of
    all three with the cell array Region. Lengths: m."""
    gap = GAP * edge ** 2
    organ = Organ(make_surface(), TOUCHED, tip_radius=tip_radius)
    of_stomach = HOLLOW[0] - HOLLOW[1], HOLLOW[0] + HOLLOW[1]
    surfaces = {LIVER: organ.refined(edge, min(1, 0.6 * tip_radius / edge)),
                BED: largest(lambda points: bed(points, gap), BED_LOW, BED_HIGH,
                             EDGES_OF_BED * edge),
                STOMACH: largest(lambda points: stomach(points, gap), *of_stomach, edge)}
    together = vtkAppendPolyData()
    for region, surface in surfaces.items():
        add_cell_array(surface, "Region", np.full(surface.GetNumberOfCells(), region, np.int32))
        together.AddInputData(surface)
    together.Update()
    return organ, together.GetOutput()
