// SPDX-License-Identifier: BSD-3-Clause
// ParaView's own readers of NRRD, MetaImage and NIfTI ignore the directions of the axes that a file
// gives, so that the image comes out turned, moved or mirrored. Some filters, such as Contour of
// VTK 9.1, likewise ignore the direction matrix of an image.
#pragma once

#include <string>

class vtkAlgorithm;

/// A sentence for each such file, and for each such contour, anywhere in the pipeline before the
/// filter; empty if everything lies as the file says, in LPS or in RAS. A file that cannot be
/// examined is named, too.
std::string vtkPalpateTellDroppedDirections(vtkAlgorithm* filter);
