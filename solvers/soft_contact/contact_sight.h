// SPDX-License-Identifier: BSD-3-Clause
// What the points of contact see of each other in a state, for the energy and its derivatives.
#pragma once

#include <vector>

#include "soft_contact/kernels.h"
#include "soft_contact/soft_contact.h"

namespace palpate {

/// The derivatives of the energy of each point by its sums.
struct SoftContact::Jets {
  std::vector<double> s, p, ss, ps, pp;

  void resize(std::size_t num_points) {
    for (std::vector<double>* values : {&s, &p, &ss, &ps, &pp}) values->resize(num_points);
  }
  void set(std::size_t point, const Jet& jet) {
    s[point] = jet.s;
    p[point] = jet.p;
    ss[point] = jet.ss;
    ps[point] = jet.ps;
    pp[point] = jet.pp;
  }
  [[nodiscard]] JetView view() const {
    return {s.data(), p.data(), ss.data(), ps.data(), pp.data()};
  }
};

/// The packets are those of the neighbours.
struct SoftContact::Sight {
  NodalVector state;
  /// Up to how many ρ points see each other.
  double around = 0;
  std::vector<PointPacket> points;
  /// S and P of each point.
  std::vector<double> s;
  std::vector<double> p;
  /// Which points have others in reach, as ContactKernels::sums() finds them.
  std::vector<unsigned char> rows;
  /// Of the last state that was evaluated.
  Jets jets;
  std::vector<double> gradient;

  [[nodiscard]] std::size_t num_points() const { return s.size(); }
  [[nodiscard]] Sums sums(std::size_t point) const { return {s[point], p[point]}; }
  /// Whether a point is none that only fills up a packet.
  [[nodiscard]] bool is_point(std::size_t number) const {
    return points[number / kPacketSize].area[number % kPacketSize] > 0;
  }
};

}  // namespace palpate
