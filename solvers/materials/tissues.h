// SPDX-License-Identifier: BSD-3-Clause
// Soft tissues with a material each, from the paper that measured it.
//
// Those measured by elastography are neo-Hookean and incompressible with E = 3μ, μ the shear
// modulus that was measured: of small vibrations, so that they say nothing of large strain, and
// rather too stiff for a slow finger. Those by indentation have the E that was measured. Both kinds
// of brain are Ogden's law, fitted by us to published mean curves of tension, compression and shear
// (to 10 % and 20 %), each weighted by its largest stress; κ makes Poisson's ratio 0.495, which was
// not measured.
#pragma once

#include <string>
#include <vector>

#include "materials/material.h"

namespace palpate {

struct Tissue {
  std::string name;
  Material material;
  /// Of the paper.
  std::string doi;
};

/// They are listed with protocols and ranges in plugin/help/tissues.md. Their order is that of the
/// numbers that users' files have: add new ones at the end.
[[nodiscard]] const std::vector<Tissue>& tissues();

}  // namespace palpate
