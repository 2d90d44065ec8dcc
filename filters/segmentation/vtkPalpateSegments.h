// SPDX-License-Identifier: BSD-3-Clause
// The segments of a segmentation as 3D Slicer saves it (.seg.nrrd): each has a name, a colour, and
// a value in one of the layers of the image. Segments of unlike layers may overlap.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

class vtkFieldData;
struct vtkPalpateImageFile;
struct vtkPalpateImageHeader;

struct vtkPalpateSegment
{
  std::string Name; ///< no other segment of the file has it
  int Layer = 0;    ///< from 0
  int Value = 0;    ///< of its voxels in that layer
  int Label = 0; ///< its value where no two of the file have the same one; else its number from 1
  std::array<double, 3> Color{}; ///< red, green, blue, from 0 to 1
};

/// The segments in the order of the file; none if it describes none.
/// @throws palpate::InputError a value or a layer is not valid.
std::vector<vtkPalpateSegment> vtkPalpateFindSegments(const vtkPalpateImageHeader& header);

struct vtkPalpateJoinedSegments
{
  std::vector<int> Labels;         ///< of the voxels
  std::vector<std::size_t> Voxels; ///< of each segment, as the file has it
  std::vector<std::size_t> Lost;   ///< how many of these are given to a later segment
  std::size_t Unnamed = 0;         ///< voxels with a value that no segment of the file has
};

/// Gives each voxel one label: where chosen segments overlap, that of the last one in the order of
/// the file.
/// @param chosen Whether each segment is chosen [number of segments].
/// @throws palpate::InputError the image does not hold whole numbers.
vtkPalpateJoinedSegments vtkPalpateJoinSegments(const vtkPalpateImageFile& image,
  const std::vector<vtkPalpateSegment>& segments, const std::vector<char>& chosen);

/// The names of labels, from the field arrays that vtkPalpateSegmentationReader gives an image;
/// none if there are no such arrays.
std::map<int, std::string> vtkPalpateNamesOfLabels(vtkFieldData* fields);
