// SPDX-License-Identifier: BSD-3-Clause
// A segmented image as a plain array of labels. Voxels that are not part of the body have 0.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "PalpateSegmentationModule.h"
#include "vtkPalpateExactPredicates.h"

class vtkImageData;

struct vtkPalpateLabelGrid
{
  std::array<int, 3> Size{};             ///< voxels along each axis of the image
  std::array<vtkPalpatePoint, 3> Axes{}; ///< from a voxel to the next along each of them, m
  vtkPalpatePoint Origin{};              ///< the middle of the first voxel, m
  /// The labels of the voxels, the first axis fastest; or the numbers of their parts, see
  /// vtkPalpateLabelParts.h.
  std::vector<int> Labels;

  std::size_t Index(int i, int j, int k) const
  {
    return (static_cast<std::size_t>(k) * Size[1] + j) * Size[0] + i;
  }
  /// The label of a voxel; 0 outside the image.
  int At(int i, int j, int k) const
  {
    const bool inside = i >= 0 && j >= 0 && k >= 0 && i < Size[0] && j < Size[1] && k < Size[2];
    return inside ? Labels[Index(i, j, k)] : 0;
  }
  /// The place of voxel coordinates, which are whole numbers at the middle of a voxel; m.
  vtkPalpatePoint Place(double i, double j, double k) const;
  /// The voxel coordinates of a place.
  std::array<double, 3> VoxelsOf(const vtkPalpatePoint& place) const;
  /// The volume of a voxel, m³; negative if the axes are left-handed.
  double SignedVolume() const;
  double Volume() const { return SignedVolume() < 0 ? -SignedVolume() : SignedVolume(); }
  /// Length of a voxel along an axis, m.
  double Spacing(int axis) const;
};

/// The largest number of voxels.
constexpr double vtkPalpateMostVoxels = 1e8;

/// A value that is this near to a whole number counts as that number, since a scaled image, or one
/// in single precision, may have 1.0000001.
constexpr double vtkPalpateLabelTolerance = 1e-3;

/// Reads the labels of an image, with its orientation and its lengths times `unit` m.
/// @param array The name of an array of the points or cells; empty: the active scalars.
/// @param wanted The labels to keep; the others become 0. Empty: all positive labels are kept.
/// @param negative Receives the number of voxels of each negative label that became 0, if `wanted`
///   is empty; may be null.
/// @throws palpate::InputError there is no such array with one whole number for each voxel, the
///   image has a single layer of voxels or more than vtkPalpateMostVoxels, its axes are not at
///   right angles, a wanted label is missing, or there are no labels at all.
PALPATESEGMENTATION_EXPORT vtkPalpateLabelGrid vtkPalpateReadLabels(vtkImageData* image,
  const std::string& array, const std::vector<int>& wanted, double unit,
  std::map<int, std::size_t>* negative = nullptr);

/// The number of voxels of each label but 0.
PALPATESEGMENTATION_EXPORT std::map<int, std::size_t> vtkPalpateCountLabels(
  const vtkPalpateLabelGrid& grid);

/// The shares of the labels in a box anywhere in an image. Between the middles of voxels the shares
/// are linear.
class PALPATESEGMENTATION_EXPORT vtkPalpateLabelShares
{
public:
  /// @param box The edges of the box, in voxels of the grid.
  vtkPalpateLabelShares(const vtkPalpateLabelGrid& grid, const std::array<double, 3>& box);

  /// @param middle The middle of the box, in voxel coordinates, see vtkPalpateLabelGrid::Place.
  void MoveTo(const std::array<double, 3>& middle);
  double Of(int label) const;
  /// The label with the largest share of the box.
  int Most() const;
  /// The labels that have a share of the box, the largest first.
  std::vector<int> InOrder() const;

private:
  const vtkPalpateLabelGrid& Grid;
  std::array<double, 3> Box;
  std::array<int, 3> Samples;
  std::vector<std::pair<int, double>> Shares;
};
