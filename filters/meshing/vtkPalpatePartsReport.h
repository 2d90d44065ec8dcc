// SPDX-License-Identifier: BSD-3-Clause
// A report on what became of the parts of a label map in the body that was made of it.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "PalpateMeshingModule.h"
#include "vtkPalpateLabelParts.h"
#include "vtkPalpateLabelSurface.h"

/// A label for a message, with its name if it has one.
PALPATEMESHING_EXPORT std::string vtkPalpateNameOfLabel(
  int label, const std::map<int, std::string>& names);

/// The parts of a body in its image, in the cubes, and in the mesh.
class PALPATEMESHING_EXPORT vtkPalpatePartsReport
{
public:
  vtkPalpatePartsReport(const vtkPalpateLabelParts& parts, const vtkPalpateCubes& cubes,
    const vtkPalpateLabelSurface& surface, const std::map<int, std::string>& names);

  double ImageVolume(std::size_t part) const;

  vtkPalpatePoint Place(std::size_t part) const;

  /// The differences from the image, the largest part of each kind first; empty if there are none.
  std::string Wrong() const;

  /// A line for each part of labels that have several, and for each cavity.
  std::string Lines() const;

private:
  static constexpr std::size_t MostLines = 100;
  static constexpr std::size_t MostNamed = 20;

  double Error(std::size_t part) const { return Surface.Volumes[part] / ImageVolume(part) - 1; }

  std::string Name(std::size_t part) const;

  /// A sentence that lists parts, the largest first. @param tell Gives the text about each.
  std::string List(const char* title, std::vector<std::size_t> parts,
    const std::function<std::string(std::size_t)>& tell) const;

  const vtkPalpateLabelParts& Parts;
  const vtkPalpateCubes& Cubes;
  const vtkPalpateLabelSurface& Surface;
  const std::map<int, std::string>& Names;
  std::map<int, std::size_t> NumberOf; ///< parts of each label
};
