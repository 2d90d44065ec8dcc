// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/shape_kind.h"

#include <utility>

#include "interaction/kind_list.h"

namespace palpate {
namespace {

KindList<ShapeKind>& kinds_of_shapes() {
  static KindList<ShapeKind> all("a shape of a tool", "A rigid tool has the unknown shape",
                                 sphere_kind(), capsule_kind(), surface_kind());
  return all;
}

}  // namespace

const ShapeKind* find_shape_kind(ToolShape number) { return kinds_of_shapes().find(number); }

const ShapeKind& shape_kind(ToolShape number) { return kinds_of_shapes().get(number); }

void add_shape_kind(std::unique_ptr<const ShapeKind> kind) {
  kinds_of_shapes().add(std::move(kind));
}

}  // namespace palpate
