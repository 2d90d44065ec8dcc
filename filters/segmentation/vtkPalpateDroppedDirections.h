// SPDX-License-Identifier: BSD-3-Clause
// ParaView's own readers of NRRD, MetaImage and NIfTI leave out where a file says that its axes
// point to: what they read comes out turned, moved or mirrored. So does what some filters, such as
// Contour of VTK 9.1, make of an image that has a direction matrix.
#pragma once

#include <string>

class vtkAlgorithm;

/// A sentence for each such file that is read before the filter, and each such contour, other
/// filters between them; empty where all lies as the file says, in LPS or in RAS.
/// One that cannot be looked at is told of, too.
std::string vtkPalpateTellDroppedDirections(vtkAlgorithm* filter);
