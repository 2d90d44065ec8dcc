// SPDX-License-Identifier: BSD-3-Clause
// Soft tissues, each with a material from the paper that measured it.
//
// Materials from elastography are neo-Hookean and incompressible with E = 3μ, where μ is the
// measured shear modulus. It was measured with small vibrations: it says nothing of large strain,
// and is rather too stiff for a slow finger. Materials from indentation have the measured E. Both
// kinds of brain have Ogden's law, which we fitted to published mean curves of tension, compression
// and shear (to 10 % and 20 %), each weighted by its largest stress; their κ gives Poisson's ratio
// 0.495, which was not measured.
#pragma once

#include <string>
#include <vector>

#include "materials/material.h"

namespace palpate {

struct Tissue {
  std::string name;
  Material material;
  /// The DOI of the paper.
  std::string doi;
  /// The energy that it takes to open an area of a crack, J/m², and the DOI of the paper; 0: we
  /// found no measurement.
  double toughness = 0;
  std::string toughness_doi = {};
};

/// The tissues, which plugin/help/tissues.md lists with protocols and ranges. Users' files store
/// places in this list: add new tissues at the end.
[[nodiscard]] const std::vector<Tissue>& tissues();

}  // namespace palpate
