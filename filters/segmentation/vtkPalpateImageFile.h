// SPDX-License-Identifier: BSD-3-Clause
// An image as it is in its file. palpate-image reads it (filters/programs/image/main.cxx).
#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "vtkPalpateExactPredicates.h"

struct vtkPalpateImageHeader
{
  std::array<int, 3> Size{};               ///< voxels along each axis
  vtkPalpatePoint Origin{};                ///< the middle of the first voxel, in the file's unit
  std::array<vtkPalpatePoint, 3> Axes{};   ///< from a voxel to the next along each axis
  int Components = 1;                      ///< values of a voxel
  bool Oriented = true;                    ///< the file says where its axes point to
  std::string Unit;                        ///< as the file names it; empty where it does not
  std::map<std::string, std::string> Keys; ///< what it says of segments

  std::size_t Count() const
  {
    return static_cast<std::size_t>(Size[0]) * static_cast<std::size_t>(Size[1]) *
      static_cast<std::size_t>(Size[2]);
  }
  /// The volume of a voxel, in the cube of the file's unit.
  double Volume() const;
};

struct vtkPalpateImageFile
{
  vtkPalpateImageHeader Header;
  /// The values of the voxels, the first axis fastest, with the components of a voxel next to each
  /// other. One of the two is empty: whole numbers are labels.
  std::vector<int> Labels;
  std::vector<double> Values;
};

/// Whether the name is that of a file which the following two functions read: NRRD, MetaImage or
/// NIfTI.
bool vtkPalpateIsImageFile(const std::string& file);

/// Reads the header of a file. Places are in LPS: x to the left of the person, y to the back, z to
/// the head.
/// @throws palpate::InputError the file cannot be read: the message says why.
/// @throws palpate::BackendError palpate-image cannot be run.
vtkPalpateImageHeader vtkPalpateReadImageHeader(const std::string& file);

/// Reads a file.
/// @param poll Called many times a second meanwhile. An exception ends the reading. May be empty.
vtkPalpateImageFile vtkPalpateReadImageFile(
  const std::string& file, const std::function<void()>& poll);

/// Reorders the voxels so that their axes point as nearly along x, y and z as they can: the sum of
/// the axes' own components is the largest. The axes are right-handed then.
void vtkPalpateArrangeImage(vtkPalpateImageFile& image);
