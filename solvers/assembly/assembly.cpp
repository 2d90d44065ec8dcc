// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/assembly.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "assembly/kernels.h"
#include "base/error.h"
#include "elements/tetrahedron.h"

namespace palpate {
namespace {

/// The elements of one law, laid out for the kernels.
struct ElementGroup {
  const Kernels* kernels = nullptr;
  /// Cell of each place [num_packets × 8]; the filling repeats the last cell.
  std::vector<Index> cells;
  Index num_cells = 0;
  std::vector<Index> nodes;
  std::vector<double> gradients;
  std::vector<double> weights;
  std::vector<double> parameters;
  bool homogeneous = true;
  std::vector<BlockTarget> targets;

  [[nodiscard]] ElementGroupView view() const {
    return {static_cast<std::int32_t>(cells.size()) / kPacketSize,
            nodes.data(),
            gradients.data(),
            weights.data(),
            parameters.data(),
            homogeneous,
            targets.data()};
  }
};

const Material& material_of(const Scene& scene, Index cell) {
  return scene.materials[scene.material_of_cell.empty() ? 0 : scene.material_of_cell[cell]];
}

/// Blocks of the lower triangle, each node's ascending list of nodes ≥ itself.
std::vector<std::vector<Index>> lower_neighbours(const TetMesh& mesh,
                                                 const std::vector<Index>& node_of_point,
                                                 Index num_nodes) {
  std::vector<std::vector<Index>> rows(num_nodes);
  const int npc = nodes_per_cell(mesh.order);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 0; a < npc; ++a) {
      const Index column = node_of_point[mesh.cell(c)[a]];
      if (column < 0) continue;
      for (int b = 0; b < npc; ++b) {
        const Index row = node_of_point[mesh.cell(c)[b]];
        if (row >= column) rows[column].push_back(row);
      }
    }
  }
  for (auto& list : rows) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    list.shrink_to_fit();
  }
  return rows;
}

SymmetricPattern make_pattern(const std::vector<std::vector<Index>>& rows) {
  SymmetricPattern pattern;
  pattern.size = 3 * static_cast<Index>(rows.size());
  std::int64_t num_values = 0;
  for (const auto& list : rows) num_values += 9 * static_cast<std::int64_t>(list.size()) - 3;
  if (num_values > std::numeric_limits<Index>::max()) {
    throw InputError("The tangent of this body would have " + std::to_string(num_values) +
                     " values; at most 2147483647 can be stored. Use a coarser mesh.");
  }
  pattern.column_start.reserve(pattern.size + 1);
  pattern.row.reserve(num_values);
  pattern.column_start.push_back(0);
  for (Index node = 0; node < static_cast<Index>(rows.size()); ++node) {
    for (int c = 0; c < 3; ++c) {
      for (Index other : rows[node]) {
        for (int r = other == node ? c : 0; r < 3; ++r) pattern.row.push_back(3 * other + r);
      }
      pattern.column_start.push_back(static_cast<Index>(pattern.row.size()));
    }
  }
  return pattern;
}

}  // namespace

struct Assembly::Data {
  Index num_points = 0;
  Index num_cells = 0;
  bool linear = true;
  double mean_edge = 0;
  std::vector<Index> unknown_of_point;
  SymmetricPattern pattern;
  std::vector<ElementGroup> groups;

  void number_unknowns(const Scene& scene);
  void make_group(const Scene& scene, Law law, const std::vector<Index>& cells,
                  const std::vector<std::vector<Index>>& rows);
  [[nodiscard]] BlockTarget target_of(Index point_a, Index point_b,
                                      const std::vector<std::vector<Index>>& rows) const;
};

void Assembly::Data::number_unknowns(const Scene& scene) {
  const std::vector<char> used = points_in_use(scene.mesh);
  unknown_of_point.assign(scene.mesh.points.size(), -1);
  Index next = 0;
  for (Index p = 0; p < scene.mesh.num_points(); ++p) {
    if (used[p] == 0 || scene.fixed[p] != 0) continue;
    unknown_of_point[p] = next;
    next += 3;
  }
}

BlockTarget Assembly::Data::target_of(Index point_a, Index point_b,
                                      const std::vector<std::vector<Index>>& rows) const {
  const Index a = unknown_of_point[point_a] / 3;
  const Index b = unknown_of_point[point_b] / 3;
  if (unknown_of_point[point_a] < 0 || unknown_of_point[point_b] < 0) return {};
  // The kernel's block has a's rows and b's columns; what is stored has row ≥ column.
  const Index row = std::max(a, b);
  const Index column = std::min(a, b);
  const auto& list = rows[column];
  const Index place =
      static_cast<Index>(std::lower_bound(list.begin(), list.end(), row) - list.begin());
  const Index length = 3 * static_cast<Index>(list.size());
  return {pattern.column_start[3 * column] + 3 * place, a < b ? -length : length};
}

void Assembly::Data::make_group(const Scene& scene, Law law, const std::vector<Index>& cells,
                                const std::vector<std::vector<Index>>& rows) {
  const TetMesh& mesh = scene.mesh;
  const int npc = nodes_per_cell(mesh.order);
  const int num_pairs = npc * (npc + 1) / 2;
  const auto& rule = quadrature(mesh.order);
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, 3>> reference;
  for (const auto& point : rule) reference.push_back(shape_gradients(mesh.order, point.xi));

  ElementGroup& group = groups.emplace_back();
  group.kernels = &best_kernels(static_cast<int>(mesh.order), static_cast<int>(law));
  group.num_cells = static_cast<Index>(cells.size());
  group.cells = cells;
  while (group.cells.size() % kPacketSize != 0) group.cells.push_back(cells.back());
  const std::size_t num_places = group.cells.size();
  group.nodes.resize(num_places * npc);
  group.gradients.resize(num_places * rule.size() * npc * 3);
  group.weights.resize(num_places * rule.size());
  group.targets.resize(num_places * num_pairs);

  const Material& first = material_of(scene, cells.front());
  group.homogeneous = std::all_of(cells.begin(), cells.end(),
                                  [&](Index c) { return material_of(scene, c) == first; });
  if (group.homogeneous) {
    const auto constants = law_constants(first);
    group.parameters.assign(constants.begin(), constants.end());
  } else {
    group.parameters.resize(num_places * 3);
  }

  for (std::size_t place = 0; place < num_places; ++place) {
    const std::size_t packet = place / kPacketSize;
    const std::size_t lane = place % kPacketSize;
    const Index c = group.cells[place];
    const Index* cell = mesh.cell(c);
    Eigen::Matrix<double, 3, Eigen::Dynamic> x(3, npc);
    for (int a = 0; a < npc; ++a) {
      x.col(a) = mesh.points[cell[a]];
      group.nodes[(packet * npc + a) * kPacketSize + lane] = cell[a];
    }
    for (std::size_t q = 0; q < rule.size(); ++q) {
      const Mat3 jacobian = x * reference[q];
      const double det = jacobian.determinant();
      if (!(det > 0)) {
        throw InputError("Cell " + std::to_string(c) + " is folded: its midside nodes are far from "
                         "the middle of their edges, so that the map onto it is not one to one. "
                         "Straighten the edges or mesh again.");
      }
      const Eigen::Matrix<double, Eigen::Dynamic, 3> gradients = reference[q] * jacobian.inverse();
      const std::size_t at = packet * rule.size() + q;
      for (int a = 0; a < npc; ++a) {
        for (int i = 0; i < 3; ++i) {
          group.gradients[((at * npc + a) * 3 + i) * kPacketSize + lane] = gradients(a, i);
        }
      }
      const bool filling = place >= cells.size();
      group.weights[at * kPacketSize + lane] = filling ? 0 : rule[q].weight * det;
    }
    if (!group.homogeneous) {
      const auto constants = law_constants(material_of(scene, c));
      for (int i = 0; i < 3; ++i) {
        group.parameters[(packet * 3 + i) * kPacketSize + lane] = constants[i];
      }
    }
    if (place >= cells.size()) continue;  // the targets of the filling stay "not stored"
    int pair = 0;
    for (int a = 0; a < npc; ++a) {
      for (int b = a; b < npc; ++b, ++pair) {
        group.targets[(packet * num_pairs + pair) * kPacketSize + lane] =
            target_of(cell[a], cell[b], rows);
      }
    }
  }
}

Assembly::Assembly(const Scene& scene) : data_(std::make_unique<Data>()) {
  const TetMesh& mesh = scene.mesh;
  data_->num_points = mesh.num_points();
  data_->num_cells = mesh.num_cells();
  data_->number_unknowns(scene);

  std::vector<Index> node_of_point(mesh.points.size(), -1);
  Index num_nodes = 0;
  for (Index p = 0; p < mesh.num_points(); ++p) {
    if (data_->unknown_of_point[p] >= 0) node_of_point[p] = num_nodes++;
  }
  const auto rows = lower_neighbours(mesh, node_of_point, num_nodes);
  data_->pattern = make_pattern(rows);

  std::map<Law, std::vector<Index>> cells_of_law;
  double edges = 0;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    cells_of_law[material_of(scene, c).law].push_back(c);
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) {
        edges += (mesh.points[mesh.cell(c)[a]] - mesh.points[mesh.cell(c)[b]]).norm();
      }
    }
  }
  data_->mean_edge = edges / (6.0 * mesh.num_cells());
  for (const auto& [law, cells] : cells_of_law) {
    data_->linear = data_->linear && law == Law::linear;
    data_->make_group(scene, law, cells, rows);
  }
}

Assembly::~Assembly() = default;
Assembly::Assembly(Assembly&&) noexcept = default;
Assembly& Assembly::operator=(Assembly&&) noexcept = default;

Index Assembly::num_points() const { return data_->num_points; }
Index Assembly::num_cells() const { return data_->num_cells; }
bool Assembly::is_linear() const { return data_->linear; }
const std::vector<Index>& Assembly::unknown_of_point() const { return data_->unknown_of_point; }
const SymmetricPattern& Assembly::pattern() const { return data_->pattern; }
double Assembly::mean_edge() const { return data_->mean_edge; }

Assembly::Result Assembly::residual(const NodalVector& u, NodalVector& force) const {
  force.setZero(3 * data_->num_points);
  Result total{0, std::numeric_limits<double>::infinity()};
  for (const auto& group : data_->groups) {
    const GroupResult part = group.kernels->residual(group.view(), u.data(), force.data());
    total.energy += part.energy;
    total.minimum_det_f = std::min(total.minimum_det_f, part.minimum_det_f);
  }
  return total;
}

Assembly::Result Assembly::tangent(const NodalVector& u, NodalVector& force,
                                   std::vector<double>& values) const {
  force.setZero(3 * data_->num_points);
  values.assign(data_->pattern.num_values(), 0.0);
  Result total{0, std::numeric_limits<double>::infinity()};
  for (const auto& group : data_->groups) {
    const GroupResult part =
        group.kernels->tangent(group.view(), u.data(), force.data(), values.data());
    total.energy += part.energy;
    total.minimum_det_f = std::min(total.minimum_det_f, part.minimum_det_f);
  }
  return total;
}

Assembly::Determinant Assembly::minimum_det_f(const NodalVector& u) const {
  Determinant least{std::numeric_limits<double>::max(), -1, 0};
  std::vector<double> determinants;
  for (const auto& group : data_->groups) {
    determinants.resize(group.cells.size());
    group.kernels->determinants(group.view(), u.data(), determinants.data());
    for (Index i = 0; i < group.num_cells; ++i) {
      if (determinants[i] <= 0) ++least.num_inverted_cells;
      if (determinants[i] < least.value) {
        least.value = determinants[i];
        least.cell = group.cells[i];
      }
    }
  }
  return least;
}

}  // namespace palpate
