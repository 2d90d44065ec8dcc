// SPDX-License-Identifier: BSD-3-Clause
#include "materials/tissues.h"

namespace palpate {
namespace {

/// @param youngs_modulus Pa.
Material neo_hookean(double youngs_modulus) {
  return make_material(Law::neo_hookean_incompressible, {youngs_modulus});
}

/// @param modulus The shear modulus, Pa.
Material sheared(double modulus) { return neo_hookean(3 * modulus); }

/// Ogden's law with one term and Poisson's ratio 0.495.
Material ogden(double modulus, double exponent) {
  constexpr double ratio = 0.495;
  const double bulk_modulus = 2 * modulus * (1 + ratio) / (3 * (1 - 2 * ratio));
  return make_material(Law::ogden, {bulk_modulus, modulus, exponent});
}

}  // namespace

const std::vector<Tissue>& tissues() {
  static const std::vector<Tissue> all = {
      {"Liver", sheared(2300), "10.2214/AJR.07.3123", 164, "10.1016/j.medengphy.2011.09.030"},
      {"Liver tumour", sheared(10100), "10.2214/AJR.07.3123"},
      {"Kidney", sheared(4900), "10.1002/jmri.22670"},
      {"Prostate", neo_hookean(17000), "10.1016/j.urology.2010.02.025"},
      {"Prostate cancer", neo_hookean(24100), "10.1016/j.urology.2010.02.025"},
      {"Breast fat", sheared(1850), "10.12659/MSM.952112"},
      {"Breast gland", sheared(2950), "10.12659/MSM.952112"},
      {"Muscle", sheared(3730), "10.1002/jmri.20487"},
      {"Brain grey matter", ogden(1472, -18.75), "10.1016/j.actbio.2016.10.036"},
      {"Brain white matter", ogden(631, -24), "10.1016/j.actbio.2016.10.036"},
      {"Glioblastoma", sheared(1320), "10.1371/journal.pone.0110588"},
  };
  return all;
}

}  // namespace palpate
