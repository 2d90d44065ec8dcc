// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/energy_hermite.h"

#include "interpolation/hermite_basis.h"
#include "interpolation/hermite_data.h"

namespace palpate {
namespace {

// The vector extension of GCC and Clang: the compiler does not find this packing by itself.
using Two = double __attribute__((vector_size(16)));

inline Two load(const double* from) {
  Two v;
  __builtin_memcpy(&v, from, sizeof v);
  return v;
}

inline void store(Two v, double* to) { __builtin_memcpy(to, &v, sizeof v); }

}  // namespace

EnergyHermite::EnergyHermite(const TouchSite& site)
    : Interpolator(site),
      data_(hermite_data(grid(), site.configurations)),
      per_spacing_(1 / grid().spacing()) {}

// The sum over 8 × 27 products is taken one axis after another.
TouchResult EnergyHermite::do_evaluate(const CellTree::Leaf& leaf, const Vec3& s) const noexcept {
  const double side = leaf.cell.side;
  const HermiteBasis bx(s[0], side);
  const HermiteBasis by(s[1], side);
  const HermiteBasis bz(s[2], side);

  // Along z [derivative][corner in y and b][corner in x and a].
  double along_z[3][6][6];
  for (int x = 0; x < 2; ++x) {
    for (int y = 0; y < 2; ++y) {
      const std::int32_t* nodes = leaf.corners.data() + 4 * x + 2 * y;
      const double* low = data_.data() + std::ptrdiff_t{kHermiteData} * nodes[0];
      const double* high = data_.data() + std::ptrdiff_t{kHermiteData} * nodes[1] - 27;
      double sum[3][10];
#pragma GCC unroll 4
      for (int ba = 0; ba < 8; ba += 2) {
        Two s0{};
        Two s1{};
        Two s2{};
#pragma GCC unroll 6
        for (int i = 0; i < 6; ++i) {
          const Two v = load((i < 3 ? low : high) + 9 * i + ba);
          s0 += bz.of[0][i] * v;
          s1 += bz.of[1][i] * v;
          s2 += bz.of[2][i] * v;
        }
        store(s0, sum[0] + ba);
        store(s1, sum[1] + ba);
        store(s2, sum[2] + ba);
      }
#pragma GCC unroll 3
      for (int order = 0; order < 3; ++order) {
        double last = 0;
        for (int i = 0; i < 6; ++i) last += bz.of[order][i] * (i < 3 ? low : high)[9 * i + 8];
        sum[order][8] = last;
        for (int ba = 0; ba < 9; ++ba)
          along_z[order][3 * y + ba / 3][3 * x + ba % 3] = sum[order][ba];
      }
    }
  }

  // Along y too [derivative along y][along z][corner in x and a].
  double along_yz[3][3][6];
  for (int z = 0; z < 3; ++z) {
    for (int y = 0; y + z < 3; ++y) {
      Two s0{};
      Two s1{};
      Two s2{};
#pragma GCC unroll 6
      for (int i = 0; i < 6; ++i) {
        const double w = by.of[y][i];
        s0 += w * load(along_z[z][i]);
        s1 += w * load(along_z[z][i] + 2);
        s2 += w * load(along_z[z][i] + 4);
      }
      store(s0, along_yz[y][z]);
      store(s1, along_yz[y][z] + 2);
      store(s2, along_yz[y][z] + 4);
    }
  }

  const auto along_x = [&](int x, int y, int z) {
    const double* w = bx.of[x];
    const double* d = along_yz[y][z];
    const Two sum = load(w) * load(d) + load(w + 2) * load(d + 2) + load(w + 4) * load(d + 4);
    return sum[0] + sum[1];
  };
  TouchResult result;
  result.energy = along_x(0, 0, 0);
  const double per_side = per_spacing_ / side;
  result.force = per_side * Vec3(along_x(1, 0, 0), along_x(0, 1, 0), along_x(0, 0, 1));
  const double xy = along_x(1, 1, 0);
  const double xz = along_x(1, 0, 1);
  const double yz = along_x(0, 1, 1);
  result.stiffness << along_x(2, 0, 0), xy, xz,  //
      xy, along_x(0, 2, 0), yz,                  //
      xz, yz, along_x(0, 0, 2);
  result.stiffness *= per_side * per_side;
  return result;
}

TouchResult EnergyHermite::do_evaluate_border(const CellTree::Leaf& leaf,
                                              const Vec3& s) const noexcept {
  return do_evaluate(leaf, s);
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
