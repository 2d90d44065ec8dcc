// SPDX-License-Identifier: BSD-3-Clause
// The law of contact says how strongly a rigid tool presses what comes near to its surface. It is
// an energy per area of the body at the distance d from the tool,
//
//   ψ = κ⟨δ − g⟩⁴ / (4 δ³),   g = d + o
//
// The pressure −ψ′ acts in a layer of thickness δ, in which it rises smoothly: ψ is C³ and zero
// beyond it, so that a tool that touches nothing adds exactly nothing. A pressure p = −ψ′ is at the
// gap δ (1 − (p/κ)^{1/3}), so that a tool seems larger by the mean of that; o draws the layer back
// into the tool, so that it seems as large as it is.
#pragma once

namespace palpate {

struct ContactLaw {
  /// δ, m.
  double thickness = 0;
  /// κ, Pa: the pressure at g = 0, which lies o inside the tool.
  double stiffness = 0;
  /// o, m, less than δ.
  double offset = 0;

  /// ψ and its derivatives by the distance.
  struct Jet {
    /// J/m².
    double value = 0;
    /// ψ′, minus the pressure, Pa; not positive.
    double slope = 0;
    /// Pa/m.
    double curvature = 0;
  };

  /// The distance outside the tool at which the layer begins, m.
  [[nodiscard]] double reach() const { return thickness - offset; }
  [[nodiscard]] bool acts_at(double distance) const { return reach() - distance > 0; }
  /// @param distance The distance d, m. It must be one at which the law acts.
  [[nodiscard]] Jet evaluate(double distance) const {
    const double depth = reach() - distance;
    const double scale = stiffness / (thickness * thickness * thickness);
    return {scale * depth * depth * depth * depth / 4, -scale * depth * depth * depth,
            3 * scale * depth * depth};
  }

  [[nodiscard]] friend bool operator==(const ContactLaw& a, const ContactLaw& b) {
    return a.thickness == b.thickness && a.stiffness == b.stiffness && a.offset == b.offset;
  }
};

/// @throws InputError the thickness or the stiffness is not positive, or the offset is out of its
///   range.
void validate(const ContactLaw& law);

}  // namespace palpate
