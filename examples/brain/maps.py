# SPDX-License-Identifier: BSD-3-Clause
"""Maps of how probable grey and white matter are (NIfTI), made into one image of labels.

ParaView's own reader of NIfTI (plugin AnalyzeNIfTIReaderWriter) knows no compressed file, and of
where the image lies in the head no more than an offset. So VTK's reader reads the maps, and their
place and directions are taken from what it says of their header: x is to the right, y to the front,
z up.
https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h
"""
import os

import numpy as np
from paraview.simple import XMLImageDataReader
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkNIFTIImageReader
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

from pipeline import Failure, update

GREY, WHITE = 1, 2
MILLIMETRES = {0: 1.0, 1: 1e3, 2: 1.0, 3: 1e-3}  # of NIfTI's codes of units; 0 is not told
OF_BYTES = 255  # what stands for certain in maps of bytes
# Of a map: how far it may go beyond certain and how far its axes from right angles, both by
# rounding, and how far two of one head may lie apart, mm.
ROUNDING, ASKEW, APART = 1e-3, 1e-3, 1e-2


class Map:
    """How probable a tissue is, `values` (z, y, x) between 0 and 1, and where in the head that is:
    spacing (x, y, z), origin (mm) and directions, a column an axis of the image."""

    def __init__(self, path, certain=None):
        """certain: the value that stands for certain; by default 255 in bytes, and otherwise 1."""
        if not os.path.isfile(path):
            raise Failure(f"there is no file {path}.")
        reader = vtkNIFTIImageReader()
        if not reader.CanReadFile(path):
            raise Failure(f"{path} is no NIfTI image.")
        reader.SetFileName(path)
        reader.Update()
        if reader.GetErrorCode() != 0:
            raise Failure(f"{path} cannot be read to its end.")
        image = reader.GetOutput()
        self.values = self.scale(path, reader, image.GetPointData().GetScalars(), certain)
        self.values = self.values.reshape(image.GetDimensions()[::-1])
        self.place(path, reader, image.GetSpacing())

    @staticmethod
    def scale(path, reader, stored, certain):
        if stored.GetNumberOfComponents() != 1:
            raise Failure(f"{path} has more than one value a voxel.")
        values = vtk_to_numpy(stored)
        slope = reader.GetRescaleSlope() or 1.0
        if certain is None:
            certain = OF_BYTES if values.dtype == np.uint8 and slope == 1 else 1
        values = (values.astype(np.float32) * slope + reader.GetRescaleIntercept()) / certain
        # Some programs have no number where there is no tissue.
        values = np.nan_to_num(values, nan=0.0)
        if values.min() < -ROUNDING or values.max() > 1 + ROUNDING or values.max() <= 0:
            raise Failure(f"{path} goes from {certain * values.min():g} to "
                          f"{certain * values.max():g}, and no probability does: which value "
                          "stands for certain? (--certain)")
        return values

    def place(self, path, reader, spacing):
        """Of the two ways in which a header may say it, the newer one first, as others do. VTK has
        turned the slices round where they would make a mirror image, and its matrices say so."""
        matrix = reader.GetSFormMatrix() or reader.GetQFormMatrix()
        rows = np.eye(4) if matrix is None else np.array(
            [[matrix.GetElement(i, j) for j in range(4)] for i in range(4)])
        lengths = np.linalg.norm(rows[:3, :3], axis=0)
        if not (lengths > 0).all():
            raise Failure(f"{path} does not say where its axes point.")
        self.directions = rows[:3, :3] / lengths
        if np.abs(self.directions.T @ self.directions - np.eye(3)).max() > ASKEW:
            raise Failure(f"the axes of {path} are not at right angles: resample it first.")
        unit = MILLIMETRES.get(reader.GetNIFTIHeader().GetXYZTUnits() & 7)
        if unit is None:
            raise Failure(f"{path} has a unit of length that NIfTI does not have.")
        self.spacing, self.origin = unit * lengths * spacing, unit * rows[:3, 3]

    def fits(self, other):
        """Whether both have the same voxels."""
        return self.values.shape == other.values.shape and all(
            np.allclose(self.at(corner), other.at(corner), rtol=0, atol=APART)
            for corner in np.vstack((np.zeros(3), np.diag(self.values.shape[::-1]))))

    def at(self, voxel):
        """The middle of a voxel (x, y, z), mm."""
        return self.origin + self.directions @ (self.spacing * voxel)

    def coarsen(self, voxel):
        """Takes the mean of blocks of about `voxel` mm; what is beyond the image is no tissue."""
        blocks = np.maximum(1, np.rint(voxel / self.spacing)).astype(int)
        per_axis = blocks[::-1]
        missing = -np.array(self.values.shape) % per_axis
        values = np.pad(self.values, [(0, number) for number in missing])
        whole = np.array(values.shape) // per_axis
        values = values.reshape(np.ravel(np.column_stack((whole, per_axis))))
        self.values = values.mean(axis=(1, 3, 5))
        self.origin = self.at((blocks - 1) / 2)
        self.spacing = self.spacing * blocks


def save_labels(grey, white, path, voxel, least):
    """Writes the image of labels, so that the readers of all ranks find it; answers with a reader
    and with the volumes of grey and white matter (m³). grey, white: maps; voxel: mm.

    Where both together are more probable than `least`, the voxel is of the likelier of the two.
    """
    if not grey.fits(white):
        raise Failure("the two maps do not have the same voxels: resample one like the other.")
    for tissue in (grey, white):
        tissue.coarsen(voxel)
    labels = np.where(grey.values + white.values > least,
                      np.where(white.values > grey.values, WHITE, GREY), 0).astype(np.uint8)
    image = vtkImageData()
    image.SetDimensions(labels.shape[::-1])
    image.SetSpacing(grey.spacing)
    image.SetOrigin(grey.origin)
    image.SetDirectionMatrix(grey.directions.ravel())
    array = numpy_to_vtk(labels.ravel(), deep=True)
    array.SetName("Label")
    image.GetPointData().SetScalars(array)
    writer = vtkXMLImageDataWriter()
    writer.SetInputData(image)
    writer.SetFileName(path)
    writer.SetDataModeToBinary()  # recent releases of Expat make readers refuse appended data
    if not writer.Write():
        raise Failure(f"cannot write {path}.")
    volumes = [1e-9 * np.prod(grey.spacing) * (labels == label).sum() for label in (GREY, WHITE)]
    return update(XMLImageDataReader(FileName=[path])), volumes
