// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/shape_kind.h"

#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

using ShapeKinds = std::vector<std::unique_ptr<const ShapeKind>>;

ShapeKinds& kinds() {
  static ShapeKinds all = [] {
    ShapeKinds built_in;
    built_in.push_back(sphere_kind());
    built_in.push_back(capsule_kind());
    built_in.push_back(surface_kind());
    return built_in;
  }();
  return all;
}

}  // namespace

const ShapeKind* find_shape_kind(ToolShape number) {
  for (const auto& kind : kinds()) {
    if (kind->number() == number) return kind.get();
  }
  return nullptr;
}

const ShapeKind& shape_kind(ToolShape number) {
  if (const ShapeKind* kind = find_shape_kind(number)) return *kind;
  throw InputError("A rigid tool has the unknown shape " +
                   std::to_string(static_cast<int>(number)) +
                   ". The file was damaged, or made by a later version.");
}

void add_shape_kind(std::unique_ptr<const ShapeKind> kind) {
  if (find_shape_kind(kind->number()) != nullptr) {
    throw InputError("There is a shape of a tool with the number " +
                     std::to_string(static_cast<int>(kind->number())) + " already.");
  }
  kinds().push_back(std::move(kind));
}

}  // namespace palpate
