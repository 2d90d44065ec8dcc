// SPDX-License-Identifier: BSD-3-Clause
// The frame of an image: where its voxels lie.
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

/// The text of a header's entry; empty: there is none.
std::string StringOf(const itk::MetaDataDictionary& dictionary, const std::string& key);

/// The frame as ITK has read it.
Frame FrameOf(const itk::ImageIOBase& io);

/// The frame of a NIfTI file's sform, if that one is valid for the file. Some versions of ITK
/// straighten a matrix with a shear, without a warning.
std::optional<Frame> SformOf(const itk::MetaDataDictionary& dictionary);

/// ITK gives the voxels of a NIfTI file in mm, but leaves its origin in the unit of the file.
void RescaleOrigin(const itk::MetaDataDictionary& dictionary, Frame& frame);

/// Checks a frame. @throws std::runtime_error it cannot be the frame of an image.
void CheckFrame(const Frame& frame);
