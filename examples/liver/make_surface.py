# SPDX-License-Identifier: BSD-3-Clause
"""A liver-like closed surface, made from implicit functions.

Sample run:
    pvpython make_surface.py liver.vtp

The axes are those of a person who faces the viewer: x to the person's left, y up, z to the front.
The body is 0.2 m wide: a large right lobe (x < 0) with a dome, a left lobe that tapers (x > 0), a
concave underside, a notch in the lower border with a fissure behind it, a hollow for the gall
bladder and a groove at the back for the great vein.
"""
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import (vtkFlyingEdges3D, vtkPolyDataConnectivityFilter,
                                       vtkWindowedSincPolyDataFilter)
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from remesh import arrays, poly_data, remesh

BOUNDS = np.array([[-0.12, 0.13], [-0.11, 0.10], [-0.10, 0.10]])  # m
SPACING = 0.004  # m, of the samples


def ellipsoid(points, centre, radii, tilt=0.0):
    """About the distance (m) to an ellipsoid that is turned by `tilt` degrees about z."""
    c, s = np.cos(np.radians(tilt)), np.sin(np.radians(tilt))
    local = (points - centre) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    scaled = np.linalg.norm(local / radii, axis=1)
    slope = np.linalg.norm(local / np.square(radii), axis=1)
    return scaled * (scaled - 1) / np.maximum(slope, 1e-12)


def capsule(points, start, end, radius):
    """The distance (m) to a rod with round ends."""
    start, axis = np.asarray(start), np.subtract(end, start)
    along = np.clip((points - start) @ axis / (axis @ axis), 0, 1)
    return np.linalg.norm(points - start - along[:, None] * axis, axis=1) - radius


def half_space(points, origin, normal):
    """The distance (m) to a plane, negative where its normal points away from."""
    return (points - origin) @ (np.asarray(normal) / np.linalg.norm(normal))


def unite(a, b, blend):
    """Both bodies, with a fillet of about `blend` m between them."""
    near = np.clip(blend - np.abs(a - b), 0, None)
    return np.minimum(a, b) - near * near / (4 * blend)


def common(a, b, blend):
    return -unite(-a, -b, blend)


def without(a, b, blend):
    return common(a, -b, blend)


def liver(points):
    """Negative inside, zero on the surface, positive outside; about the distance in m."""
    right = ellipsoid(points, (-0.038, 0.004, -0.006), (0.060, 0.074, 0.064), tilt=-14)
    middle = ellipsoid(points, (0.005, 0.022, 0.006), (0.055, 0.046, 0.050), tilt=12)
    left = ellipsoid(points, (0.056, 0.040, 0.012), (0.056, 0.024, 0.036), tilt=-10)
    body = unite(unite(right, middle, 0.03), left, 0.03)

    # The lower border runs obliquely up to the left.
    body = common(body, half_space(points, (0.0, -0.034, 0.0), (0.40, -0.87, 0.10)), 0.012)
    # The underside: the stomach on the left, the kidney and the bowel on the right.
    body = without(body, ellipsoid(points, (0.066, -0.050, -0.040), (0.070, 0.070, 0.078)), 0.014)
    body = without(body, ellipsoid(points, (-0.026, -0.088, -0.064), (0.060, 0.080, 0.070)), 0.016)
    # The notch with its fissure, the gall bladder, the great vein.
    body = without(body, capsule(points, (0.013, -0.034, 0.075), (0.020, 0.010, -0.030), 0.013),
                   0.014)
    body = without(body, capsule(points, (-0.034, -0.056, 0.024), (-0.014, -0.022, -0.006), 0.012),
                   0.014)
    body = without(body, capsule(points, (0.004, -0.05, -0.066), (0.008, 0.11, -0.052), 0.013),
                   0.012)
    return body


def contour(function, low, high, edge_length, only_largest=False):
    """The closed surface on which function(points) is 0, negative inside, as vtkPolyData, normals
    outwards, with edges of about that length (m).
    low, high: corners of the box that is sampled; only_largest: of several surfaces."""
    numbers = np.round((high - low) / SPACING).astype(int) + 1
    z, y, x = np.meshgrid(*(low[k] + SPACING * np.arange(numbers[k]) for k in (2, 1, 0)),
                          indexing="ij")
    image = vtkImageData()
    image.SetOrigin(low)
    image.SetSpacing(SPACING, SPACING, SPACING)
    image.SetDimensions(*(int(n) for n in numbers))
    values = function(np.column_stack([x.ravel(), y.ravel(), z.ravel()]))
    scalars = numpy_to_vtk(values, deep=True)
    scalars.SetName("Distance")
    image.GetPointData().SetScalars(scalars)

    surface = vtkFlyingEdges3D()
    surface.SetInputData(image)
    surface.SetValue(0, 0.0)
    surface.ComputeScalarsOff()
    surface.ComputeNormalsOff()
    if only_largest:
        largest = vtkPolyDataConnectivityFilter()
        largest.SetInputConnection(surface.GetOutputPort())
        largest.SetExtractionModeToLargestRegion()
        surface = largest
    smooth = vtkWindowedSincPolyDataFilter()
    smooth.SetInputConnection(surface.GetOutputPort())
    smooth.SetNumberOfIterations(30)
    smooth.SetPassBand(0.05)
    smooth.NormalizeCoordinatesOn()
    smooth.Update()
    # A contour's triangles face the side where the values fall: here the inside.
    points, corners = arrays(remesh(smooth.GetOutput(), edge_length))
    return poly_data(points, corners[:, ::-1])


def make_surface(edge_length=0.0065):
    """The liver, with edges of about that length (m)."""
    return contour(liver, BOUNDS[:, 0], BOUNDS[:, 1], edge_length)


def main():
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(make_surface())
    writer.SetFileName(sys.argv[1])
    writer.SetDataModeToBinary()  # recent releases of Expat make readers refuse appended data
    if not writer.Write():
        sys.exit(f"make_surface.py: cannot write {sys.argv[1]}.")


if __name__ == "__main__":
    main()
