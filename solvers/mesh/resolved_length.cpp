// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/resolved_length.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

Eigen::AlignedBox3d box_around(const TetMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& point : mesh.points) box.extend(point);
  return box;
}

}  // namespace

double size_of(const TetMesh& mesh) {
  const Eigen::AlignedBox3d box = box_around(mesh);
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

void check_resolved(const TetMesh& mesh, const std::string& name, double length) {
  const Eigen::AlignedBox3d box = box_around(mesh);
  if (box.isEmpty()) return;
  const double largest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  const double least = kLeastResolved * std::max(box.diagonal().norm(), largest);
  if (length >= least) return;
  throw InputError(name + " is " + quantity(length, "m") +
                   ", too small to be told from 0 beside a body whose points are at up to " +
                   quantity(largest, "m") + ". Give " + quantity(least, "m") +
                   " or more; lengths are in m.");
}

void check_not_too_large(const TetMesh& mesh, const std::string& name, double length) {
  const double size = size_of(mesh);
  if (size == 0 || length <= kMostResolved * size) return;
  throw InputError(name + " is " + quantity(length, "m") + ", too large beside a body of " +
                   quantity(size, "m") + " for its place to be told. Give " +
                   quantity(kMostResolved * size, "m") + " or less; lengths are in m.");
}

}  // namespace palpate
