// SPDX-License-Identifier: BSD-3-Clause
// The messages between the ranks of a run, as bytes. Values are unpacked in the order in which they
// were packed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "assembly/scene.h"
#include "base/error.h"
#include "fields/packed_basis.h"
#include "schedule/communicator.h"
#include "state_space/configuration.h"
#include "state_space/test_point.h"
#include "state_space/tool_space.h"

namespace palpate {

/// Whether values of a type are sent as their bytes in memory. Types with Eigen vectors of a fixed
/// size are, though C++ does not call them trivially copyable.
template <class T>
struct IsPlain : std::is_trivially_copyable<T> {};
/// Whether a pair is trivially copyable for C++ depends on its first type, so pairs go part by
/// part.
template <class A, class B>
struct IsPlain<std::pair<A, B>> : std::false_type {};
template <>
struct IsPlain<ConfigurationSummary> : std::true_type {};
template <>
struct IsPlain<IntermediateState> : std::true_type {};
template <>
struct IsPlain<Grid> : std::true_type {};

/// Calls visit for each part of a value that is not plain.
template <class A, class B, class Visit>
void for_each_part(std::pair<A, B>& both, Visit&& visit) {
  visit(both.first);
  visit(both.second);
}
template <class Visit>
void for_each_part(Configuration& configuration, Visit&& visit) {
  visit(static_cast<ConfigurationSummary&>(configuration));
  for_each_field(configuration, visit);
}
template <class Visit>
void for_each_part(RigidTool& tool, Visit&& visit) {
  visit(tool.shape);
  visit(tool.radius);
  visit(tool.axis);
  visit(tool.length);
  visit(tool.points);
  visit(tool.triangles);
  visit(tool.law);
}
template <class Visit>
void for_each_part(InteractionSpec& interaction, Visit&& visit) {
  visit(interaction.kind);
  visit(interaction.material_point);
  visit(interaction.active_node);
  visit(interaction.tip_radius);
  visit(interaction.tool);
}
template <class Visit>
void for_each_part(ToolSpaceSetup& setup, Visit&& visit) {
  visit(setup.id);
  visit(setup.interaction);
  visit(setup.grid);
  visit(setup.policy);
}
template <class Visit>
void for_each_part(TestPoint& point, Visit&& visit) {
  for_each_number_of_test_point(point, visit);
  visit(point.displacement);
}

template <class Visit>
void for_each_part(BasisHead& head, Visit&& visit) {
  visit(head.box);
  visit(head.keep);
  visit(head.largest_displacement);
  visit(head.displacement_error);
  visit(head.sensitivity_error);
}
template <class Visit>
void for_each_part(FieldBasis& basis, Visit&& visit) {
  visit(static_cast<BasisHead&>(basis));
  visit(basis.modes);
  visit(basis.pressure_modes);
  visit(basis.steps);
}
template <class Visit>
void for_each_part(PackedBasis& basis, Visit&& visit) {
  visit(static_cast<BasisHead&>(basis));
  visit(basis.num_modes);
  visit(basis.num_pressure_modes);
  visit(basis.num_pressures);
  visit(basis.steps);
  visit(basis.numbers);
}
template <class Visit>
void for_each_part(ReducedFields& fields, Visit&& visit) {
  for_each_field(fields, visit);
}
template <class Visit>
void for_each_part(PackedReduction& reduction, Visit&& visit) {
  visit(reduction.basis);
  visit(reduction.fields);
}
template <class Visit>
void for_each_part(Snapshots& snapshots, Visit&& visit) {
  visit(snapshots.u);
  visit(snapshots.w);
  visit(snapshots.p);
  visit(snapshots.p_w);
}

template <class Visit>
void for_each_part(SettledBody& settled, Visit&& visit) {
  visit(settled.u);
  visit(settled.p);
}
template <class Visit>
void for_each_part(Scene& scene, Visit&& visit) {
  visit(scene.mesh.order);
  visit(scene.mesh.points);
  visit(scene.mesh.cells);
  visit(scene.materials);
  visit(scene.material_of_cell);
  visit(scene.fixed);
  visit(scene.touchable);
  visit(scene.held_directions);
  visit(scene.support_stiffness);
  visit(scene.applied_pressure);
  visit(scene.applied_traction);
  visit(scene.body_force);
  visit(scene.densities);
  visit(scene.settled);
}

class Packer {
 public:
  template <class T>
  void put(const T& value) {
    if constexpr (IsPlain<T>::value) {
      put(&value, sizeof value);
    } else {
      // The same visitor reads and writes the parts.
      for_each_part(const_cast<T&>(value), [this](const auto& part) { put(part); });
    }
  }
  template <class Scalar, int rows, int columns>
  void put(const Eigen::Matrix<Scalar, rows, columns>& matrix) {
    put(std::array<std::int64_t, 2>{matrix.rows(), matrix.cols()});
    put(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(Scalar));
  }
  template <class Key, class T>
  void put(const std::map<Key, T>& map) {
    put_list(map);
  }
  template <class T>
  void put(const std::vector<T>& list) {
    if constexpr (IsPlain<T>::value) {
      put(list.size());
      put(list.data(), list.size() * sizeof(T));
    } else {
      put_list(list);
    }
  }
  /// Packs the number of values, then each value.
  /// @param list Any container of values that can be packed.
  template <class List>
  void put_list(const List& list) {
    put(list.size());
    for (const auto& value : list) put(value);
  }

  [[nodiscard]] Bytes take() { return std::move(bytes_); }

 private:
  void put(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }

  Bytes bytes_;
};

/// Takes values out of bytes, which must outlive it. A size is checked against the bytes that are
/// left before memory is allocated for it.
/// @throws BackendError the bytes do not hold such a value.
class Unpacker {
 public:
  explicit Unpacker(const Bytes& bytes) : bytes_(bytes) {}

  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

  template <class T>
  [[nodiscard]] T take() {
    T value;
    take(value);
    return value;
  }
  template <class T>
  void take(T& value) {
    if constexpr (IsPlain<T>::value) {
      take(static_cast<void*>(&value), sizeof value);
    } else {
      for_each_part(value, [this](auto& part) { take(part); });
    }
  }
  template <class Scalar, int rows, int columns>
  void take(Eigen::Matrix<Scalar, rows, columns>& matrix) {
    const auto shape = take<std::array<std::int64_t, 2>>();
    require((rows < 0 || shape[0] == rows) && (columns < 0 || shape[1] == columns));
    require(shape[0] >= 0 && shape[1] >= 0);
    // A matrix without values may have any number of rows or columns that a matrix can have.
    const auto most = static_cast<std::int64_t>(std::numeric_limits<Index>::max());
    require(shape[0] <= most && shape[1] <= most);
    require_left(static_cast<std::size_t>(shape[0] * shape[1]), sizeof(Scalar));
    matrix.resize(shape[0], shape[1]);
    take(static_cast<void*>(matrix.data()),
         static_cast<std::size_t>(matrix.size()) * sizeof(Scalar));
  }
  template <class Key, class T>
  void take(std::map<Key, T>& map) {
    map = take_list<std::map<Key, T>>();
  }
  template <class T>
  void take(std::vector<T>& list) {
    if constexpr (IsPlain<T>::value) {
      const auto count = take<std::size_t>();
      require_left(count, sizeof(T));
      list.resize(count);
      take(static_cast<void*>(list.data()), list.size() * sizeof(T));
    } else {
      list = take_list<std::vector<T>>();
    }
  }
  /// Takes what Packer::put_list() has packed, into a container that the caller chooses.
  template <class List>
  [[nodiscard]] List take_list() {
    List list;
    for (auto left = take<std::size_t>(); left > 0; --left) {
      list.insert(list.end(), take<Value<List>>());
    }
    return list;
  }

 private:
  /// The type of a container's values; for a map, with keys that are not constant.
  template <class List>
  struct ValueOf {
    using Type = typename List::value_type;
  };
  template <class Key, class T>
  struct ValueOf<std::map<Key, T>> {
    using Type = std::pair<Key, T>;
  };
  template <class List>
  using Value = typename ValueOf<List>::Type;

  static void require(bool good) {
    if (good) return;
    throw BackendError("What a rank of the run has sent is damaged. Start the run again.");
  }
  void require_left(std::size_t count, std::size_t size) const {
    require(count <= (bytes_.size() - at_) / size);
  }
  void take(void* data, std::size_t size) {
    require_left(size, 1);
    if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }

  const Bytes& bytes_;
  std::size_t at_ = 0;
};

/// Appends the lists of the other ranks, by rank, to that of rank 0, and empties them.
/// @note Collective
template <class T>
void gather(std::vector<T>& list, Communicator& communicator) {
  Packer mine;
  if (communicator.rank() != 0) mine.put_list(std::exchange(list, {}));
  std::vector<Bytes> all = communicator.gather(mine.take());
  agree(communicator, [&] {
    for (Bytes& bytes : all) {
      if (bytes.empty()) continue;
      for (T& value : Unpacker(bytes).take_list<std::vector<T>>()) list.push_back(std::move(value));
      bytes = {};
    }
  });
}

}  // namespace palpate
