// SPDX-License-Identifier: BSD-3-Clause
// Whether a file has all the voxels that its header tells of.
#pragma once

#include <string>

#include "image/nrrd_header.h"

/// @param bytes What the voxels take when they are not compressed.
/// @throws std::runtime_error they are not all there.
void CheckNrrd(const std::string& file, const NrrdHeader& header, double bytes);
void CheckMetaImage(const std::string& file, double bytes);
void CheckNifti(const std::string& file, const itk::MetaDataDictionary& dictionary);
