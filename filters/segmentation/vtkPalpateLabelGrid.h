// SPDX-License-Identifier: BSD-3-Clause
// A segmented image as a plain array of labels. 0 is what is not part of the body.
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
  /// Of the voxels, the first axis fastest; or the numbers of parts, see vtkPalpateLabelParts.h.
  std::vector<int> Labels;

  std::size_t Index(int i, int j, int k) const
  {
    return (static_cast<std::size_t>(k) * Size[1] + j) * Size[0] + i;
  }
  /// 0 outside the image.
  int At(int i, int j, int k) const
  {
    const bool inside = i >= 0 && j >= 0 && k >= 0 && i < Size[0] && j < Size[1] && k < Size[2];
    return inside ? Labels[Index(i, j, k)] : 0;
  }
  /// Place of a voxel, whose middle has whole numbers; m.
  vtkPalpatePoint Place(double i, double j, double k) const;
  /// The other way round.
  std::array<double, 3> VoxelsOf(const vtkPalpatePoint& place) const;
  /// Of a voxel, m³; negative where the axes are left-handed.
  double SignedVolume() const;
  double Volume() const { return SignedVolume() < 0 ? -SignedVolume() : SignedVolume(); }
  /// Length of a voxel along an axis, m.
  double Spacing(int axis) const;
};

/// More voxels are refused.
constexpr double vtkPalpateMostVoxels = 1e8;

/// A value this near to a whole number is that number: a scaled image or one in single precision
/// has 1.0000001.
constexpr double vtkPalpateLabelTolerance = 1e-3;

/// The labels of an image, with its orientation, its lengths times `unit` m.
/// @param array The name of an array of the points or cells; empty: the active scalars.
/// @param wanted The labels to keep, the others become 0; empty: all that are positive.
/// @param negative Gets the number of voxels of each negative label that became 0, unless `wanted`
/// says what is kept; null: nobody asks.
/// @throws palpate::InputError no such array with one whole number for each, an image of a single
/// layer of voxels, more voxels than above, axes that are not at right angles, a wanted label that
/// is not there, or none at all.
PALPATESEGMENTATION_EXPORT vtkPalpateLabelGrid vtkPalpateReadLabels(vtkImageData* image,
  const std::string& array, const std::vector<int>& wanted, double unit,
  std::map<int, std::size_t>* negative = nullptr);

/// The number of voxels of each label but 0.
PALPATESEGMENTATION_EXPORT std::map<int, std::size_t> vtkPalpateCountLabels(
  const vtkPalpateLabelGrid& grid);

/// Which labels are how much of a box anywhere in an image. Between the middles of voxels their
/// shares are linear.
class PALPATESEGMENTATION_EXPORT vtkPalpateLabelShares
{
public:
  /// @param box Its edges, in voxels of the grid.
  vtkPalpateLabelShares(const vtkPalpateLabelGrid& grid, const std::array<double, 3>& box);

  /// @param middle Of the box, in voxels, as of vtkPalpateLabelGrid::Place.
  void MoveTo(const std::array<double, 3>& middle);
  double Of(int label) const;
  /// The label that has most of it.
  int Most() const;
  /// Those that have some of it, that with most first.
  std::vector<int> InOrder() const;

private:
  const vtkPalpateLabelGrid& Grid;
  std::array<double, 3> Box;
  std::array<int, 3> Samples;
  std::vector<std::pair<int, double>> Shares;
};
