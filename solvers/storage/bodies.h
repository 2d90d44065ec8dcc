// SPDX-License-Identifier: BSD-3-Clause
// The bodies of a file: the tables scene, material, body_force, boundary_array, body_contact and
// body_cut.
//
// A file has one body at least. Several are discretisations of one organ: they have meshes of their
// own, the same materials and body force, and all or none of them supports and loads of the
// surface.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "fields/reduced_fields.h"
#include "state_space/space_body.h"
#include "storage/connection.h"

namespace palpate::storage {

/// What is known of a body when a file is open.
struct BodyHead {
  BodyId number = kFirstBody;
  /// The result of hash(scene).
  std::string hash;
  double solver_tolerance = 0;
  std::int64_t num_points = 0;
  std::int64_t num_cells = 0;
};

class Bodies {
 public:
  /// Reads the heads.
  /// @throws InputError there is no first body, or a body is larger than a file can hold.
  explicit Bodies(Connection& connection);

  /// Writes the first body of a new file.
  static void write_first(const sqlite::Database& database, const Scene& scene,
                          const SettledBody& at_rest, double solver_tolerance);
  /// @throws InputError a row cannot hold its fields.
  static void require_size(const Scene& scene);

  /// Adds a body of the organ. Of one that is there, takes over where it may be touched.
  /// @param scene_hash hash(scene).
  /// @throws InputError it is of another organ, it is held or loaded otherwise, or it is too large.
  BodyId add(const Scene& scene, const std::string& scene_hash, const SettledBody& at_rest);
  /// The numbers, ascending; the first is kFirstBody.
  [[nodiscard]] std::vector<BodyId> list() const;
  /// The body with a hash, or nothing.
  [[nodiscard]] std::optional<BodyId> find(const std::string& hash) const;
  /// @throws InputError there is no such body.
  [[nodiscard]] const BodyHead& head(BodyId body) const;
  [[nodiscard]] std::int64_t num_points(BodyId body) const { return head(body).num_points; }
  /// The solver tolerance, which all bodies of a file have in common.
  [[nodiscard]] double solver_tolerance() const { return head(kFirstBody).solver_tolerance; }

  /// Reads the scene of a body, and checks its rest.
  /// @throws InputError it is damaged: it does not have the hash that it is stored with.
  [[nodiscard]] Scene read(BodyId body) const;
  /// Reads all bodies.
  [[nodiscard]] std::vector<SpaceBody> read_all() const;
  void set_touchable(BodyId body, const std::vector<char>& touchable) const;

  /// The number of pressures of mixed cells. It is counted when it is first asked for.
  [[nodiscard]] Index num_pressures(BodyId body) const;
  /// The body at rest under its load. It is read when it is first asked for.
  [[nodiscard]] const SettledBody& settled(BodyId body) const;
  /// The result of kept_points(). It is made when it is first asked for.
  [[nodiscard]] const std::vector<Index>& points_of(BodyId body, Keep keep) const;

  /// The numbers of pressures of bodies that were counted already.
  using NumPressures = std::map<BodyId, Index>;
  /// From now on numbers of pressures are looked up in `known` before they are counted, and are
  /// added to it, so that several objects of one file share them.
  void share(NumPressures& known) { num_pressures_ = &known; }

 private:
  /// The parts of a body that were read already.
  struct Read {
    /// Its mesh and its cut.
    std::optional<Body> body;
    std::optional<SettledBody> settled;
    std::map<Keep, std::vector<Index>> points;
  };

  void read_heads();
  [[nodiscard]] TetMesh read_mesh(BodyId body) const;
  /// Reads the materials, and which of them each cell has.
  /// @throws InputError one is no valid material.
  void read_materials(BodyId body, Scene& scene) const;
  /// Reads the body force, the densities and the body's rest.
  /// @param organ Its materials were read before.
  /// @throws InputError they are damaged.
  void read_body_force(BodyId body, Organ& organ, SettledBody& at_rest) const;
  /// Reads what holds and loads the surface, and the body's rest if it is stored there.
  /// @throws InputError it is damaged.
  void read_boundary(BodyId body, Scene& scene, SettledBody& at_rest) const;
  /// Reads which parts touch each other.
  /// @throws InputError it is damaged.
  void read_contact(BodyId body, Scene& scene) const;
  /// Reads the cut, if the body has one.
  /// @throws InputError it is damaged.
  void read_cut(BodyId body, Cut& cut) const;

  Connection& connection_;
  std::map<BodyId, BodyHead> heads_;
  mutable std::map<BodyId, Read> read_;
  mutable NumPressures own_num_pressures_;
  NumPressures* num_pressures_ = &own_num_pressures_;
};

}  // namespace palpate::storage
