// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/assembly.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "assembly/kernels.h"
#include "assembly/packet_sets.h"
#include "assembly/pressures.h"
#include "base/error.h"
#include "base/parallel.h"
#include "elements/inversion.h"
#include "elements/tetrahedron.h"
#include "materials/rheology.h"
#include "mesh/bisection_order.h"

namespace palpate {
namespace {

/// Pairs of corners of a tetrahedron, those of a corner with itself included.
constexpr int kCornerPairs = 10;

/// The positions of the nodes of a displaced Tet10.
std::array<Vec3, 10> nodes_of(const std::vector<Vec3>& points, const Index* cell,
                              const NodalVector& displacement) {
  std::array<Vec3, 10> nodes;
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    nodes[a] = points[cell[a]] + displacement.segment<3>(3 * Eigen::Index{cell[a]});
  }
  return nodes;
}

/// The items in an order that is given by their indices.
std::vector<Index> reordered(const std::vector<Index>& items, std::vector<Index> order) {
  for (Index& i : order) i = items[i];
  return order;
}

/// The free nodes in an order in which parts of the body are compact. Within a part the corners
/// come first: they have the most neighbours, and long rows take less time per value than short
/// ones.
std::vector<Index> order_nodes(const TetMesh& mesh, const std::vector<Index>& nodes) {
  std::vector<char> is_corner(mesh.points.size(), 0);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 0; a < 4; ++a) is_corner[mesh.cell(c)[a]] = 1;
  }
  std::vector<Vec3> places;
  std::vector<char> goes_first;
  for (const Index p : nodes) {
    places.push_back(mesh.points[p]);
    goes_first.push_back(is_corner[p]);
  }
  const auto num_nodes = static_cast<Index>(nodes.size());
  const Index num_parts = Ranges(num_nodes, kNodesOfPart).num_parts();
  return reordered(nodes,
                   order_by_bisection(places, (num_nodes + num_parts - 1) / num_parts, goes_first));
}

/// Cells in an order in which sets of packets are compact.
std::vector<Index> order_cells(const TetMesh& mesh, const std::vector<Index>& cells) {
  std::vector<Vec3> places;
  for (const Index c : cells) {
    Vec3& sum = places.emplace_back(Vec3::Zero());
    for (int a = 0; a < 4; ++a) sum += mesh.points[mesh.cell(c)[a]];
  }
  return reordered(cells, order_by_bisection(places, kCellsOfSet));
}

/// @throws InputError the mapping of a Tet10 is not one to one.
void check_one_to_one(const TetMesh& mesh) {
  const NodalVector none = NodalVector::Zero(3 * Eigen::Index{mesh.num_points()});
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    if (!find_inversion(corner_jacobians(nodes_of(mesh.points, mesh.cell(c), none)))) continue;
    throw InputError("Cell " + std::to_string(c) +
                     " is folded: its midside nodes are far from the "
                     "middle of their edges, so that the map onto it is not one to one. Straighten "
                     "the edges or mesh again.");
  }
}

/// The elements of one law of energy and one formulation, laid out for the kernels.
struct ElementGroup {
  const Kernels* kernels = nullptr;
  const MemoryKernels* memory_kernels = nullptr;
  /// The number of quadrature points, and the barycentric coordinates of each [points × 4].
  int num_points = 0;
  std::vector<double> corner_shares;
  /// The cell at each position [num_packets × 8]; the last packet is filled up with the last cell.
  std::vector<Index> cells;
  Index num_cells = 0;
  std::vector<Index> nodes;
  std::vector<double> gradients;
  std::vector<double> weights;
  std::vector<double> parameters;
  bool homogeneous = true;
  std::vector<BlockTarget> targets;
  // The following are for mixed elements; else they are empty.
  std::vector<Index> pressures;
  std::vector<BlockTarget> coupling_targets;
  std::vector<Index> pressure_targets;
  PacketSets sets;

  [[nodiscard]] ElementGroupView view(Index set) const {
    return {sets.start[set],        sets.start[set + 1], num_points,
            corner_shares.data(),   nodes.data(),        gradients.data(),
            weights.data(),         parameters.data(),   homogeneous,
            targets.data(),         pressures.data(),    coupling_targets.data(),
            pressure_targets.data()};
  }
};

bool is_mixed(const Scene& scene, Index cell) {
  return is_mixed(scene.material_of(cell).formulation);
}

const std::vector<QuadraturePoint>& rule_of(const Material& material, ElementOrder order) {
  const bool is_fine =
      material.formulation == Formulation::mixed_fine && order == ElementOrder::quadratic;
  return is_fine ? fine_quadrature() : quadrature(order);
}

const Kernels& kernels_of(const Material& material, ElementOrder order) {
  return best_kernels(static_cast<int>(order), static_cast<int>(law_of_energy(material.law)),
                      is_mixed(material.formulation));
}

void sort_and_make_unique(std::vector<std::vector<Index>>& lists) {
  for (auto& list : lists) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    list.shrink_to_fit();
  }
}

Index place_in(const std::vector<Index>& list, Index value) {
  return static_cast<Index>(std::lower_bound(list.begin(), list.end(), value) - list.begin());
}

}  // namespace

struct Assembly::Data {
  Index num_points = 0;
  Index num_cells = 0;
  /// The scale of each pressure, Pa/m.
  std::vector<double> pressure_scale;
  bool linear = true;
  bool stabilised = false;
  bool takes_finer_quadrature = false;
  double mean_edge = 0;
  std::vector<Index> unknown_of_point;
  std::vector<Index> state_of_unknown;
  std::vector<Index> multipliers;
  SymmetricPattern pattern;
  std::vector<ElementGroup> groups;
  /// Points and cells of a Tet10 mesh; empty for Tet4, in whose cells det F is constant.
  std::vector<Vec3> points;
  std::vector<Index> quadratic_cells;

  // The following are used only during construction.

  Index num_nodes = 0;
  /// The pressure of each corner of each mixed cell, −1 for other cells [num_cells × 4]; empty if
  /// there is no mixed cell.
  std::vector<Index> pressure_of_corner;
  /// The index of each pressure among those that are unknowns; −1: it is not an unknown
  /// [num_pressures].
  std::vector<Index> unknown_of_pressure;
  /// Least shear modulus of the mixed materials, Pa.
  double softest = std::numeric_limits<double>::infinity();

  [[nodiscard]] Index num_pressures() const { return static_cast<Index>(pressure_scale.size()); }
  /// The decade above the softest mixed material in which a material lies.
  [[nodiscard]] int decade_of(const Material& material) const {
    return decade_above(softest, material);
  }
  [[nodiscard]] double pressure_scale_of(const Material& material) const;
  [[nodiscard]] std::vector<double> kernel_parameters(const Material& material,
                                                      ElementOrder order) const;
  /// Parameters of a material whose energy is multiplied by a factor.
  [[nodiscard]] std::vector<double> scaled_parameters(const Material& material, ElementOrder order,
                                                      double factor) const;

  /// Whether nodes and cells are ordered such that parts of the body are compact, for threads. A
  /// body that is a single part keeps its order.
  [[nodiscard]] bool is_large() const { return Ranges(num_nodes, kNodesOfPart).num_parts() > 1; }
  void number_nodes(const Scene& scene);
  void number_pressures(const Scene& scene);
  [[nodiscard]] Couplings find_couplings(const TetMesh& mesh) const;
  void make_group(const Scene& scene, const std::vector<Index>& cells, const Couplings& couplings);
  template <class Kernel>
  [[nodiscard]] Result sum_over_sets(Kernel&& kernel) const;
  [[nodiscard]] Index node_of(Index point) const {
    return unknown_of_point[point] < 0 ? -1 : unknown_of_point[point] / 3;
  }
  [[nodiscard]] BlockTarget target_of(Index point_a, Index point_b,
                                      const Couplings& couplings) const;
  [[nodiscard]] BlockTarget coupling_target_of(Index point, Index pressure,
                                               const Couplings& couplings) const;
  [[nodiscard]] Index pressure_target_of(Index a, Index b, const Couplings& couplings) const;
};

void Assembly::Data::number_nodes(const Scene& scene) {
  const std::vector<char> used = points_in_use(scene.body.mesh);
  unknown_of_point.assign(scene.body.mesh.points.size(), -1);
  std::vector<Index> free;
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    if (used[p] != 0 && scene.body.fixed[p] == 0) free.push_back(p);
  }
  num_nodes = static_cast<Index>(free.size());
  if (is_large()) free = order_nodes(scene.body.mesh, free);
  for (Index node = 0; node < num_nodes; ++node) {
    unknown_of_point[free[node]] = 3 * node;
    for (Index i = 0; i < 3; ++i) state_of_unknown.push_back(3 * free[node] + i);
  }
}

std::vector<double> Assembly::Data::kernel_parameters(const Material& material,
                                                      ElementOrder order) const {
  const auto constants = law_constants(material);
  std::vector<double> parameters(constants.begin(), constants.end());
  parameters.resize(kernels_of(material, order).num_constants);
  if (is_mixed(material.formulation)) {
    parameters.push_back(volumetric_compliance(material));
    parameters.push_back(1 / (2 * shear_modulus(material)));
    parameters.push_back(pressure_scale_of(material));
  }
  return parameters;
}

std::vector<double> Assembly::Data::scaled_parameters(const Material& material, ElementOrder order,
                                                      double factor) const {
  std::vector<double> parameters = kernel_parameters(material, order);
  const auto constants = law_constants(scaled(material, factor));
  std::copy_n(constants.begin(), kernels_of(material, order).num_constants, parameters.begin());
  return parameters;
}

double Assembly::Data::pressure_scale_of(const Material& material) const {
  // The scale is a power of two, so that scaling a pressure and back changes no bit.
  return std::ldexp(1.0, std::ilogb(softest * std::pow(10, decade_of(material)) / mean_edge));
}

void Assembly::Data::number_pressures(const Scene& scene) {
  softest = softest_mixed(scene.organ.materials);
  if (std::isinf(softest)) return;
  const TetMesh& mesh = scene.body.mesh;
  pressure_of_corner.assign(4 * static_cast<std::size_t>(mesh.num_cells()), -1);
  std::map<std::tuple<Index, Law, int>, Index> numbers;
  std::vector<char> felt;
  std::vector<char> incompressible;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    if (!is_mixed(scene, c)) continue;
    const Material& material = scene.material_of(c);
    const Index* cell = mesh.cell(c);
    const bool has_free_point =
        std::any_of(cell, cell + nodes_per_cell(mesh.order),
                    [&](Index point) { return unknown_of_point[point] >= 0; });
    for (int a = 0; a < 4; ++a) {
      const auto [entry, is_new] = numbers.try_emplace(
          {cell[a], law_of_energy(material.law), decade_of(material)}, num_pressures());
      if (is_new) {
        pressure_scale.push_back(pressure_scale_of(material));
        felt.push_back(0);
        incompressible.push_back(1);
      }
      pressure_of_corner[4 * c + a] = entry->second;
      felt[entry->second] |= has_free_point ? 1 : 0;
      incompressible[entry->second] &= volumetric_compliance(material) == 0 ? 1 : 0;
    }
  }
  unknown_of_pressure.assign(num_pressures(), -1);
  Index next = 0;
  for (Index j = 0; j < num_pressures(); ++j) {
    if (felt[j] == 0) continue;
    unknown_of_pressure[j] = next++;
    if (incompressible[j] != 0) multipliers.push_back(static_cast<Index>(state_of_unknown.size()));
    state_of_unknown.push_back(3 * num_points + j);
  }
}

Couplings Assembly::Data::find_couplings(const TetMesh& mesh) const {
  Couplings couplings;
  couplings.nodes.resize(num_nodes);
  couplings.pressures_of_node.resize(num_nodes);
  couplings.pressures.resize(state_of_unknown.size() - 3 * static_cast<std::size_t>(num_nodes));
  const int npc = nodes_per_cell(mesh.order);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    std::array<Index, 4> pressures{-1, -1, -1, -1};
    for (int a = 0; a < 4 && !pressure_of_corner.empty(); ++a) {
      const Index pressure = pressure_of_corner[4 * c + a];
      if (pressure >= 0) pressures[a] = unknown_of_pressure[pressure];
    }
    for (int a = 0; a < npc; ++a) {
      const Index column = node_of(cell[a]);
      if (column < 0) continue;
      for (int b = 0; b < npc; ++b) {
        const Index row = node_of(cell[b]);
        if (row >= column) couplings.nodes[column].push_back(row);
      }
      for (Index pressure : pressures) {
        if (pressure >= 0) couplings.pressures_of_node[column].push_back(pressure);
      }
    }
    for (Index column : pressures) {
      for (Index row : pressures) {
        if (column >= 0 && row >= column) couplings.pressures[column].push_back(row);
      }
    }
  }
  sort_and_make_unique(couplings.nodes);
  sort_and_make_unique(couplings.pressures_of_node);
  sort_and_make_unique(couplings.pressures);
  return couplings;
}

BlockTarget Assembly::Data::target_of(Index point_a, Index point_b,
                                      const Couplings& couplings) const {
  const Index a = node_of(point_a);
  const Index b = node_of(point_b);
  if (a < 0 || b < 0) return {};
  // The kernel's block has the rows of a and the columns of b; the stored one has row ≥ column.
  const Index row = std::max(a, b);
  const Index column = std::min(a, b);
  const Index length = couplings.column_length(column);
  return {pattern.column_start[3 * column] + 3 * place_in(couplings.nodes[column], row),
          a < b ? -length : length};
}

BlockTarget Assembly::Data::coupling_target_of(Index point, Index pressure,
                                               const Couplings& couplings) const {
  const Index column = node_of(point);
  const Index row = unknown_of_pressure[pressure];
  if (column < 0 || row < 0) return {};
  const auto above = static_cast<Index>(3 * couplings.nodes[column].size());
  return {
      pattern.column_start[3 * column] + above + place_in(couplings.pressures_of_node[column], row),
      couplings.column_length(column)};
}

Index Assembly::Data::pressure_target_of(Index a, Index b, const Couplings& couplings) const {
  const auto [column, row] = std::minmax(unknown_of_pressure[a], unknown_of_pressure[b]);
  if (column < 0) return -1;
  return pattern.column_start[3 * num_nodes + column] + place_in(couplings.pressures[column], row);
}

void Assembly::Data::make_group(const Scene& scene, const std::vector<Index>& cells,
                                const Couplings& couplings) {
  const TetMesh& mesh = scene.body.mesh;
  const Material& first = scene.material_of(cells.front());
  const bool mixed = is_mixed(first.formulation);
  const int npc = nodes_per_cell(mesh.order);
  const int num_pairs = npc * (npc + 1) / 2;
  const auto& rule = rule_of(first, mesh.order);
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, 3>> reference;
  for (const auto& point : rule) reference.push_back(shape_gradients(mesh.order, point.xi));

  ElementGroup& group = groups.emplace_back();
  group.num_points = static_cast<int>(rule.size());
  for (const auto& point : rule) {
    const Eigen::VectorXd shares = shape_values(ElementOrder::linear, point.xi);
    group.corner_shares.insert(group.corner_shares.end(), shares.begin(), shares.end());
  }
  group.kernels = &kernels_of(first, mesh.order);
  group.memory_kernels =
      &best_memory_kernels(static_cast<int>(mesh.order), law_of_energy(first.law) == Law::linear);
  group.num_cells = static_cast<Index>(cells.size());
  group.cells = is_large() ? order_cells(mesh, cells) : cells;
  while (group.cells.size() % kPacketSize != 0)
    group.cells.push_back(group.cells[cells.size() - 1]);
  const std::size_t num_places = group.cells.size();
  group.nodes.resize(num_places * npc);
  group.gradients.resize(num_places * rule.size() * npc * 3);
  group.weights.resize(num_places * rule.size());
  group.targets.resize(num_places * num_pairs);
  if (mixed) {
    group.pressures.resize(num_places * 4);
    group.coupling_targets.resize(num_places * npc * 4);
    group.pressure_targets.assign(num_places * kCornerPairs, -1);
  }

  group.homogeneous = std::all_of(cells.begin(), cells.end(),
                                  [&](Index c) { return scene.material_of(c) == first; });
  group.parameters = kernel_parameters(first, mesh.order);
  const std::size_t num_parameters = group.parameters.size();
  if (!group.homogeneous) group.parameters.resize(num_places * num_parameters);

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
      const auto parameters = kernel_parameters(scene.material_of(c), mesh.order);
      for (std::size_t i = 0; i < num_parameters; ++i) {
        group.parameters[(packet * num_parameters + i) * kPacketSize + lane] = parameters[i];
      }
    }
    const Index* pressures =
        mixed ? pressure_of_corner.data() + 4 * static_cast<std::size_t>(c) : nullptr;
    for (int a = 0; a < 4 && mixed; ++a) {
      group.pressures[(packet * 4 + a) * kPacketSize + lane] = 3 * num_points + pressures[a];
    }
    if (place >= cells.size()) continue;  // targets of the filling stay "not stored"
    int pair = 0;
    for (int a = 0; a < npc; ++a) {
      for (int b = a; b < npc; ++b, ++pair) {
        group.targets[(packet * num_pairs + pair) * kPacketSize + lane] =
            target_of(cell[a], cell[b], couplings);
      }
    }
    if (!mixed) continue;
    for (int a = 0; a < npc; ++a) {
      for (int b = 0; b < 4; ++b) {
        group.coupling_targets[(packet * npc * 4 + a * 4 + b) * kPacketSize + lane] =
            coupling_target_of(cell[a], pressures[b], couplings);
      }
    }
    pair = 0;
    for (int a = 0; a < 4; ++a) {
      for (int b = a; b < 4; ++b, ++pair) {
        group.pressure_targets[(packet * kCornerPairs + pair) * kPacketSize + lane] =
            pressure_target_of(pressures[a], pressures[b], couplings);
      }
    }
  }
  const auto num_packets = static_cast<Index>(num_places) / kPacketSize;
  group.sets = is_large() ? make_coloured_sets(num_packets, group.nodes, num_points)
                          : make_one_set(num_packets);
}

/// Sums the results of `kernel` over the sets of packets, in their order.
template <class Kernel>
Assembly::Result Assembly::Data::sum_over_sets(Kernel&& kernel) const {
  Result total{0, std::numeric_limits<double>::infinity()};
  std::vector<GroupResult> results;
  for (const ElementGroup& group : groups) {
    results.resize(static_cast<std::size_t>(group.sets.num_sets()));
    for (const std::vector<Index>& of_colour : group.sets.colours) {
      for_each_part(static_cast<Index>(of_colour.size()), [&](Index i) {
        const Index set = of_colour[i];
        results[set] = kernel(group, group.view(set));
      });
    }
    for (const GroupResult& part : results) {
      total.energy += part.energy;
      total.minimum_det_f = std::min(total.minimum_det_f, part.minimum_det_f);
    }
  }
  return total;
}

Assembly::Assembly(const Scene& scene) : data_(std::make_unique<Data>()) {
  const TetMesh& mesh = scene.body.mesh;
  data_->num_points = mesh.num_points();
  data_->num_cells = mesh.num_cells();
  data_->stabilised = mesh.order == ElementOrder::linear;
  // Cells of one group share a kernel.
  std::map<std::pair<Law, Formulation>, std::vector<Index>> cells_of_group;
  double edges = 0;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Material& material = scene.material_of(c);
    cells_of_group[{law_of_energy(material.law), material.formulation}].push_back(c);
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) {
        edges += (mesh.points[mesh.cell(c)[a]] - mesh.points[mesh.cell(c)[b]]).norm();
      }
    }
  }
  if (mesh.order == ElementOrder::quadratic) {
    check_one_to_one(mesh);
    data_->points = mesh.points;
    data_->quadratic_cells = mesh.cells;
  }
  data_->mean_edge = edges / (6.0 * mesh.num_cells());
  data_->number_nodes(scene);
  data_->number_pressures(scene);
  const Couplings couplings = data_->find_couplings(mesh);
  data_->pattern = make_pattern(couplings);
  for (const auto& [kind, cells] : cells_of_group) {
    data_->linear = data_->linear && kind.first == Law::linear;
    data_->takes_finer_quadrature |=
        mesh.order == ElementOrder::quadratic && kind.second == Formulation::mixed;
    data_->make_group(scene, cells, couplings);
  }
  data_->pressure_of_corner = {};
  data_->unknown_of_pressure = {};
}

Assembly::~Assembly() = default;
Assembly::Assembly(Assembly&&) noexcept = default;
Assembly& Assembly::operator=(Assembly&&) noexcept = default;

Index Assembly::num_points() const { return data_->num_points; }
Index Assembly::num_cells() const { return data_->num_cells; }
Index Assembly::num_pressures() const { return data_->num_pressures(); }
Index Assembly::state_size() const { return 3 * data_->num_points + num_pressures(); }
const std::vector<double>& Assembly::pressure_scale() const { return data_->pressure_scale; }
const std::vector<Index>& Assembly::state_of_unknown() const { return data_->state_of_unknown; }
Index Assembly::num_unknown_pressures() const { return data_->pattern.size - 3 * data_->num_nodes; }
bool Assembly::has_stabilised_pressures() const { return data_->stabilised; }
const std::vector<Index>& Assembly::multipliers() const { return data_->multipliers; }
bool Assembly::takes_finer_quadrature() const { return data_->takes_finer_quadrature; }
bool Assembly::is_linear() const { return data_->linear; }
const std::vector<Index>& Assembly::unknown_of_point() const { return data_->unknown_of_point; }
const SymmetricPattern& Assembly::pattern() const { return data_->pattern; }
double Assembly::mean_edge() const { return data_->mean_edge; }

Assembly::Result Assembly::residual(const NodalVector& state, NodalVector& force) const {
  force.setZero(state_size());
  return data_->sum_over_sets([&](const ElementGroup& group, const ElementGroupView& set) {
    return group.kernels->residual(set, state.data(), force.data());
  });
}

Assembly::Result Assembly::tangent(const NodalVector& state, NodalVector& force,
                                   std::vector<double>& values) const {
  force.setZero(state_size());
  values.resize(data_->pattern.num_values());
  for_each_range({data_->pattern.num_values(), kNumbersOfPart}, [&](Index first, Index last) {
    std::fill(values.begin() + first, values.begin() + last, 0.0);
  });
  return data_->sum_over_sets([&](const ElementGroup& group, const ElementGroupView& set) {
    return group.kernels->tangent(set, state.data(), force.data(), values.data());
  });
}

std::vector<double> Assembly::minimum_det_f_of_cells(const NodalVector& state) const {
  std::vector<double> of_cells(data_->num_cells);
  std::vector<double> of_group;
  for (const auto& group : data_->groups) {
    of_group.resize(group.cells.size());
    for_each_part(group.sets.num_sets(), [&](Index set) {
      group.kernels->determinants(group.view(set), state.data(), of_group.data());
    });
    for (Index i = 0; i < group.num_cells; ++i) of_cells[group.cells[i]] = of_group[i];
  }
  if (data_->quadratic_cells.empty()) return of_cells;
  const NodalVector none = NodalVector::Zero(3 * Eigen::Index{data_->num_points});
  for (Index c = 0; c < data_->num_cells; ++c) {
    const Index* cell = data_->quadratic_cells.data() + c * nodes_per_cell(ElementOrder::quadratic);
    const CornerJacobians jacobians = corner_jacobians(nodes_of(data_->points, cell, state));
    const CornerJacobians at_rest = corner_jacobians(nodes_of(data_->points, cell, none));
    for (int corner = 0; corner < 4; ++corner) {
      of_cells[c] =
          std::min(of_cells[c], jacobians[corner].determinant() / at_rest[corner].determinant());
    }
    if (!(of_cells[c] > 0)) continue;
    const auto place = find_inversion(jacobians);
    if (!place) continue;
    of_cells[c] = std::min(0.0, determinant(jacobians, *place) / determinant(at_rest, *place));
  }
  return of_cells;
}

Eigen::MatrixXd Assembly::stress_sums(const NodalVector& state) const {
  Eigen::MatrixXd of_cells(StressSum::count, data_->num_cells);
  std::vector<double> of_group;
  for (const auto& group : data_->groups) {
    of_group.resize(StressSum::count * group.cells.size());
    for_each_part(group.sets.num_sets(), [&](Index set) {
      group.kernels->stress(group.view(set), state.data(), of_group.data());
    });
    for (Index i = 0; i < group.num_cells; ++i) {
      const double* packet = of_group.data() + i / kPacketSize * StressSum::count * kPacketSize;
      for (int sum = 0; sum < StressSum::count; ++sum) {
        of_cells(sum, group.cells[i]) = packet[sum * kPacketSize + i % kPacketSize];
      }
    }
  }
  return of_cells;
}

std::vector<Index> Assembly::pressures_of_corners() const {
  std::vector<Index> pressures(4 * static_cast<std::size_t>(data_->num_cells), -1);
  for (const ElementGroup& group : data_->groups) {
    for (std::size_t i = 0; i < group.pressures.size(); ++i) {
      const std::size_t packet = i / (4 * kPacketSize);
      const std::size_t corner = i / kPacketSize % 4;
      const Index cell = group.cells[packet * kPacketSize + i % kPacketSize];
      pressures[4 * static_cast<std::size_t>(cell) + corner] =
          group.pressures[i] - 3 * data_->num_points;
    }
  }
  return pressures;
}

std::vector<std::vector<Index>> Assembly::cells_of_groups() const {
  std::vector<std::vector<Index>> cells;
  for (const ElementGroup& group : data_->groups) cells.push_back(group.cells);
  return cells;
}

PointTensors Assembly::make_point_tensors() const {
  PointTensors tensors;
  for (const ElementGroup& group : data_->groups) tensors.emplace_back(6 * group.weights.size());
  return tensors;
}

std::vector<const std::vector<double>*> Assembly::weights_of_groups() const {
  std::vector<const std::vector<double>*> weights;
  for (const ElementGroup& group : data_->groups) weights.push_back(&group.weights);
  return weights;
}

void Assembly::stress_at_points(const NodalVector& state, PointTensors& stress) const {
  for (std::size_t g = 0; g < data_->groups.size(); ++g) {
    const ElementGroup& group = data_->groups[g];
    for_each_part(group.sets.num_sets(), [&](Index set) {
      group.kernels->point_stress(group.view(set), state.data(), stress[g].data());
    });
  }
}

void Assembly::strain_at_points(const NodalVector& state, PointTensors& strain) const {
  for (std::size_t g = 0; g < data_->groups.size(); ++g) {
    const ElementGroup& group = data_->groups[g];
    for_each_part(group.sets.num_sets(), [&](Index set) {
      group.memory_kernels->strain(group.view(set), state.data(), strain[g].data());
    });
  }
}

double Assembly::add_memory(const Memory& memory, const NodalVector& state, NodalVector& force,
                            std::vector<double>* values) const {
  return data_
      ->sum_over_sets([&](const ElementGroup& group, const ElementGroupView& set) {
        const auto g = static_cast<std::size_t>(&group - data_->groups.data());
        const MemoryView view{memory.stress[g].data(), memory.moduli[g].data()};
        const double energy =
            values == nullptr
                ? group.memory_kernels->residual(set, view, state.data(), force.data())
                : group.memory_kernels->tangent(set, view, state.data(), force.data(),
                                                values->data());
        return GroupResult{energy, 1};
      })
      .energy;
}

void Assembly::scale_energy(const Scene& scene, const std::vector<double>& factors) {
  for (ElementGroup& group : data_->groups) {
    const std::size_t count =
        group.homogeneous ? group.parameters.size() : group.parameters.size() / group.cells.size();
    const std::size_t num_places = group.homogeneous ? 1 : group.cells.size();
    for (std::size_t place = 0; place < num_places; ++place) {
      const Index cell = group.cells[place];
      const Index number = scene.body.material_of(cell);
      const std::vector<double> parameters = data_->scaled_parameters(
          scene.organ.materials[number], scene.body.mesh.order, factors[number]);
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t packet = place / kPacketSize;
        group.parameters[group.homogeneous ? i
                                           : (packet * count + i) * kPacketSize +
                                                 place % kPacketSize] = parameters[i];
      }
    }
  }
}

Assembly::Determinant Assembly::minimum_det_f(const NodalVector& state) const {
  Determinant least{std::numeric_limits<double>::max(), -1, 0};
  const std::vector<double> of_cells = minimum_det_f_of_cells(state);
  for (Index c = 0; c < data_->num_cells; ++c) {
    if (of_cells[c] <= 0) ++least.num_inverted_cells;
    if (least.cell < 0 || of_cells[c] < least.value) {
      least.value = of_cells[c];
      least.cell = c;
    }
  }
  return least;
}

}  // namespace palpate
