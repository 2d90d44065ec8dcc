// SPDX-License-Identifier: BSD-3-Clause
// Checks that a file has all the voxels that its header promises.
#pragma once

#include <string>

#include "image/nrrd_header.h"

/// @param bytes The size of the voxels without compression.
/// @throws std::runtime_error voxels are missing.
void CheckNrrd(const std::string& file, const NrrdHeader& header, double bytes);
void CheckMetaImage(const std::string& file, double bytes);
void CheckNifti(const std::string& file, const itk::MetaDataDictionary& dictionary);
