// SPDX-License-Identifier: BSD-3-Clause
// Where the voxels of an image lie.
#pragma once

#include <array>
#include <optional>
#include <string>

#include <itkImageIOBase.h>
#include <itkMetaDataObject.h>

constexpr int Dimension = 3;

using Vector = std::array<double, Dimension>;

struct Frame
{
  Vector Origin{};
  std::array<Vector, Dimension> Axes{};
};

/// What a header says by that name; empty: nothing.
std::string StringOf(const itk::MetaDataDictionary& dictionary, const std::string& key);

/// As ITK has read it.
Frame FrameOf(const itk::ImageIOBase& io);

/// As the sform of a NIfTI file has it, where it is what counts: some versions of ITK straighten a
/// matrix that shears, without a word.
std::optional<Frame> SformOf(const itk::MetaDataDictionary& dictionary);

/// ITK gives the voxels of a NIfTI file in mm, but leaves its origin in the unit of the file.
void RescaleOrigin(const itk::MetaDataDictionary& dictionary, Frame& frame);

/// @throws std::runtime_error the frame is none of an image.
void CheckFrame(const Frame& frame);
