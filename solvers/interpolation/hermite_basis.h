// SPDX-License-Identifier: BSD-3-Clause
// The quintic Hermite basis on [0, 1]: B₀, B₁, B₂ have the value, the slope and the second
// derivative 1 at one end, and nothing else at either.
//
//   left   B₀ = 1 − 10s³ + 15s⁴ − 6s⁵   B₁ = s − 6s³ + 8s⁴ − 3s⁵     B₂ = ½s² − 1.5s³ + 1.5s⁴ − ½s⁵
//   right  B₀ = 10s³ − 15s⁴ + 6s⁵       B₁ = −4s³ + 7s⁴ − 3s⁵        B₂ = ½s³ − s⁴ + ½s⁵
#pragma once

namespace palpate {

/// Values, first and second derivatives with respect to s of the six functions: left B₀ B₁ B₂,
/// right B₀ B₁ B₂. The right ones are the left ones mirrored; in factors each is exact at both ends.
struct HermiteBasis {
  double of[3][6];

  /// @param side The data of a node are derivatives with respect to x, s = x/side.
  HermiteBasis(double s, double side) {
    const double r = 1 - s;
    const double s2 = s * s;
    const double r2 = r * r;
    const double s3 = s2 * s;
    const double r3 = r2 * r;
    const double sr = s * r;
    of[0][0] = r3 * (1 + 3 * s + 6 * s2);
    of[0][1] = s * r3 * (1 + 3 * s);
    of[0][2] = 0.5 * s2 * r3;
    of[0][3] = s3 * (1 + 3 * r + 6 * r2);
    of[0][4] = -r * s3 * (1 + 3 * r);
    of[0][5] = 0.5 * r2 * s3;
    of[1][0] = -30 * s2 * r2;
    of[1][1] = r2 * (1 + 2 * s - 15 * s2);
    of[1][2] = sr * r * (1 - 2.5 * s);
    of[1][3] = -of[1][0];
    of[1][4] = s2 * (1 + 2 * r - 15 * r2);
    of[1][5] = -sr * s * (1 - 2.5 * r);
    of[2][0] = 60 * sr * (s - r);
    of[2][1] = -12 * sr * (3 - 5 * s);
    of[2][2] = r * (1 - 8 * s + 10 * s2);
    of[2][3] = -of[2][0];
    of[2][4] = 12 * sr * (3 - 5 * r);
    of[2][5] = s * (1 - 8 * r + 10 * r2);
    const double side2 = side * side;
    for (auto& derivative : of) {
      derivative[1] *= side;
      derivative[2] *= side2;
      derivative[4] *= side;
      derivative[5] *= side2;
    }
  }
};

}  // namespace palpate
