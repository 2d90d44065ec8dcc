// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/energy_hermite.h"

#include "interpolation/hermite_data.h"

namespace palpate {
namespace {

/// Values, first and second derivatives with respect to s of the six basis functions: left B₀ B₁ B₂,
/// right B₀ B₁ B₂.
struct Basis {
  double of[3][6];

  explicit Basis(double s) {
    const double s2 = s * s;
    const double s3 = s2 * s;
    const double s4 = s2 * s2;
    const double s5 = s4 * s;
    of[0][3] = 10 * s3 - 15 * s4 + 6 * s5;
    of[0][0] = 1 - of[0][3];
    of[0][1] = s - 6 * s3 + 8 * s4 - 3 * s5;
    of[0][2] = 0.5 * s2 - 1.5 * s3 + 1.5 * s4 - 0.5 * s5;
    of[0][4] = -4 * s3 + 7 * s4 - 3 * s5;
    of[0][5] = 0.5 * s3 - s4 + 0.5 * s5;
    of[1][3] = 30 * s2 - 60 * s3 + 30 * s4;
    of[1][0] = -of[1][3];
    of[1][1] = 1 - 18 * s2 + 32 * s3 - 15 * s4;
    of[1][2] = s - 4.5 * s2 + 6 * s3 - 2.5 * s4;
    of[1][4] = -12 * s2 + 28 * s3 - 15 * s4;
    of[1][5] = 1.5 * s2 - 4 * s3 + 2.5 * s4;
    of[2][3] = 60 * s - 180 * s2 + 120 * s3;
    of[2][0] = -of[2][3];
    of[2][1] = -36 * s + 96 * s2 - 60 * s3;
    of[2][2] = 1 - 9 * s + 18 * s2 - 10 * s3;
    of[2][4] = -24 * s + 84 * s2 - 60 * s3;
    of[2][5] = 3 * s - 12 * s2 + 10 * s3;
  }
};

/// Derivatives along (y, z) and (x, y, z) that are asked for: up to the second in all.
constexpr int kYZ[6][2] = {{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {0, 2}};

}  // namespace

EnergyHermite::EnergyHermite(const TouchSite& site)
    : Interpolator(site), data_(hermite_data(grid(), site)), per_spacing_(1 / grid().spacing()) {}

// The sum over 8 × 27 products is taken one axis after another: z first, where the data of the two
// nodes of an edge lie side by side.
TouchResult EnergyHermite::do_evaluate(std::int32_t first, const Vec3& s) const noexcept {
  const Basis bx(s[0]);
  const Basis by(s[1]);
  const Basis bz(s[2]);

  // Along z [derivative][corner in y][b][corner in x and a].
  double along_z[3][2][3][6];
  for (int x = 0; x < 2; ++x) {
    for (int y = 0; y < 2; ++y) {
      const double* d = data_.data() + std::size_t{kHermiteData} *
                                           (first + x * grid().stride(0) + y * grid().stride(1));
      for (int order = 0; order < 3; ++order) {
        const double* w = bz.of[order];
        double sum[9];
        for (int i = 0; i < 9; ++i) {
          sum[i] = w[0] * d[i] + w[1] * d[9 + i] + w[2] * d[18 + i] + w[3] * d[27 + i] +
                   w[4] * d[36 + i] + w[5] * d[45 + i];
        }
        for (int i = 0; i < 9; ++i) along_z[order][y][i / 3][3 * x + i % 3] = sum[i];
      }
    }
  }
  // Along y too [derivatives][corner in x and a].
  double along_yz[6][6];
  for (int i = 0; i < 6; ++i) {
    const double* w = by.of[kYZ[i][0]];
    const auto& low = along_z[kYZ[i][1]][0];
    const auto& high = along_z[kYZ[i][1]][1];
    for (int a = 0; a < 6; ++a) {
      along_yz[i][a] = w[0] * low[0][a] + w[1] * low[1][a] + w[2] * low[2][a] +
                       w[3] * high[0][a] + w[4] * high[1][a] + w[5] * high[2][a];
    }
  }
  const auto along_x = [&](int order, int yz) {
    const double* w = bx.of[order];
    const double* d = along_yz[yz];
    return w[0] * d[0] + w[1] * d[1] + w[2] * d[2] + w[3] * d[3] + w[4] * d[4] + w[5] * d[5];
  };
  TouchResult result;
  result.energy = along_x(0, 0);
  result.force = per_spacing_ * Vec3(along_x(1, 0), along_x(0, 1), along_x(0, 3));
  const double scale = per_spacing_ * per_spacing_;
  Mat3& k = result.stiffness;
  k(0, 0) = scale * along_x(2, 0);
  k(1, 1) = scale * along_x(0, 2);
  k(2, 2) = scale * along_x(0, 5);
  k(0, 1) = k(1, 0) = scale * along_x(1, 1);
  k(0, 2) = k(2, 0) = scale * along_x(1, 3);
  k(1, 2) = k(2, 1) = scale * along_x(0, 4);
  return result;
}

TouchResult EnergyHermite::do_evaluate_border(std::int32_t first, const Vec3& s) const noexcept {
  return do_evaluate(first, s);
}

TouchResult EnergyHermite::do_check_point(std::int32_t node) const noexcept {
  const double* d = data_.data() + std::size_t{kHermiteData} * node;
  const auto at = [&](int a, int b, int c) { return d[hermite_index(a, b, c)]; };
  TouchResult result;
  result.energy = at(0, 0, 0);
  result.force = per_spacing_ * Vec3(at(1, 0, 0), at(0, 1, 0), at(0, 0, 1));
  result.stiffness << at(2, 0, 0), at(1, 1, 0), at(1, 0, 1),  //
      at(1, 1, 0), at(0, 2, 0), at(0, 1, 1),                  //
      at(1, 0, 1), at(0, 1, 1), at(0, 0, 2);
  result.stiffness *= per_spacing_ * per_spacing_;
  return result;
}

}  // namespace palpate
