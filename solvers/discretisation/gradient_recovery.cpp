// SPDX-License-Identifier: BSD-3-Clause
#include "discretisation/gradient_recovery.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "elements/tetrahedron.h"

namespace palpate {
namespace {

/// How many points a fit has for each of its terms, at the least: with as many points as terms it
/// would follow each jump.
constexpr double kPointsOfTerm = 2.4;

constexpr int kTermsOfDegree[3] = {1, 4, 10};

using Vector9 = Eigen::Matrix<double, 9, 1>;

/// The monomials up to the second degree, of which the first `terms` are used.
Eigen::VectorXd monomials(const Vec3& x, int terms) {
  Eigen::VectorXd all(10);
  all << 1, x[0], x[1], x[2], x[0] * x[0], x[1] * x[1], x[2] * x[2], x[0] * x[1], x[1] * x[2],
      x[0] * x[2];
  return all.head(terms);
}

/// The cells around the corners of each tissue.
class Patches {
 public:
  using Corner = std::pair<Index, Index>;

  Patches(const TetMesh& mesh, const std::vector<Index>& tissue_of_cell)
      : mesh_(mesh), tissue_of_cell_(tissue_of_cell) {
    for (Index c = 0; c < mesh.num_cells(); ++c) {
      for (int a = 0; a < 4; ++a) cells_[{tissue(c), mesh.cell(c)[a]}].push_back(c);
    }
  }

  [[nodiscard]] Index tissue(Index cell) const {
    return tissue_of_cell_.empty() ? 0 : tissue_of_cell_[cell];
  }
  /// By tissue and point.
  [[nodiscard]] const std::map<Corner, std::vector<Index>>& cells() const { return cells_; }

  /// The cells around a corner, and those around these, until there are enough; or all of the
  /// tissue that hang together.
  [[nodiscard]] std::set<Index> grown(const Corner& corner, std::size_t enough) const {
    const std::vector<Index>& around = cells_.at(corner);
    std::set<Index> patch(around.begin(), around.end());
    while (patch.size() < enough) {
      std::set<Index> larger = patch;
      for (const Index c : patch) {
        for (int a = 0; a < 4; ++a) {
          const std::vector<Index>& next = cells_.at({corner.first, mesh_.cell(c)[a]});
          larger.insert(next.begin(), next.end());
        }
      }
      if (larger.size() == patch.size()) break;
      patch = std::move(larger);
    }
    return patch;
  }

 private:
  const TetMesh& mesh_;
  const std::vector<Index>& tissue_of_cell_;
  std::map<Corner, std::vector<Index>> cells_;
};

}  // namespace

GradientRecovery::GradientRecovery(const TetMesh& mesh, const std::vector<Index>& tissue_of_cell)
    : nodes_per_cell_(nodes_per_cell(mesh.order)),
      points_per_cell_(static_cast<int>(quadrature(mesh.order).size())),
      mesh_nodes_(mesh.cells) {
  make_gradients(mesh);
  make_nodes(mesh, tissue_of_cell);
}

void GradientRecovery::make_gradients(const TetMesh& mesh) {
  const std::vector<QuadraturePoint>& rule = quadrature(mesh.order);
  shape_.resize(nodes_per_cell_, points_per_cell_);
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, 3>> reference;
  for (int q = 0; q < points_per_cell_; ++q) {
    shape_.col(q) = shape_values(mesh.order, rule[q].xi);
    reference.push_back(shape_gradients(mesh.order, rule[q].xi));
  }
  const Index num_points = mesh.num_cells() * points_per_cell_;
  shape_gradients_.resize(3, Eigen::Index{num_points} * nodes_per_cell_);
  Eigen::Matrix3Xd x(3, nodes_per_cell_);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 0; a < nodes_per_cell_; ++a) x.col(a) = mesh.points[mesh.cell(c)[a]];
    for (int q = 0; q < points_per_cell_; ++q) {
      const Mat3 jacobian = x * reference[q];
      const auto point = static_cast<Eigen::Index>(weights_.size());
      shape_gradients_.middleCols(point * nodes_per_cell_, nodes_per_cell_) =
          (reference[q] * jacobian.inverse()).transpose();
      weights_.push_back(rule[q].weight * jacobian.determinant());
      places_.emplace_back(x * shape_.col(q));
    }
  }
}

void GradientRecovery::make_nodes(const TetMesh& mesh, const std::vector<Index>& tissue_of_cell) {
  const Patches patches(mesh, tissue_of_cell);
  std::map<Patches::Corner, Index> numbers;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 0; a < nodes_per_cell_; ++a) {
      const auto [entry, is_new] = numbers.try_emplace({patches.tissue(c), mesh.cell(c)[a]},
                                                       static_cast<Index>(numbers.size()));
      node_of_cell_.push_back(entry->second);
    }
  }
  nodes_.resize(numbers.size());
  std::vector<std::map<Index, double>> weights(numbers.size());
  std::vector<int> num_fits(numbers.size(), 0);

  const int degree = static_cast<int>(mesh.order);
  const double cells_of_term = kPointsOfTerm / points_per_cell_;
  for (const auto& [corner, around] : patches.cells()) {
    const auto enough = [&](int terms) { return static_cast<std::size_t>(cells_of_term * terms); };
    const std::set<Index> patch = patches.grown(corner, enough(kTermsOfDegree[degree]));
    int terms = kTermsOfDegree[degree];
    for (int d = degree; d > 0 && patch.size() < enough(terms); --d) terms = kTermsOfDegree[d - 1];

    const Vec3& centre = mesh.points[corner.second];
    double extent = 0;
    for (const Index c : patch) {
      for (int a = 0; a < 4; ++a) {
        extent = std::max(extent, (mesh.points[mesh.cell(c)[a]] - centre).norm());
      }
    }
    std::vector<Index> points;
    for (const Index c : patch) {
      for (int q = 0; q < points_per_cell_; ++q) points.push_back(c * points_per_cell_ + q);
    }
    Eigen::MatrixXd fit(points.size(), terms);
    for (std::size_t s = 0; s < points.size(); ++s) {
      fit.row(static_cast<Eigen::Index>(s)) =
          monomials((places_[points[s]] - centre) / extent, terms).transpose();
    }
    const Eigen::MatrixXd coefficients = fit.completeOrthogonalDecomposition().pseudoInverse();

    std::set<Index> fitted{corner.second};
    for (const Index c : around) {
      for (int e = 4; e < nodes_per_cell_; ++e) {
        const auto& edge = kTetEdges[e - 4];
        if (mesh.cell(c)[edge[0]] == corner.second || mesh.cell(c)[edge[1]] == corner.second) {
          fitted.insert(mesh.cell(c)[e]);
        }
      }
    }
    for (const Index point : fitted) {
      const Eigen::RowVectorXd at =
          monomials((mesh.points[point] - centre) / extent, terms).transpose() * coefficients;
      const Index node = numbers.at({corner.first, point});
      ++num_fits[node];
      for (std::size_t s = 0; s < points.size(); ++s) {
        weights[node][points[s]] += at[static_cast<Eigen::Index>(s)];
      }
    }
  }
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    for (const auto& [point, weight] : weights[n]) {
      nodes_[n].points.push_back(point);
      nodes_[n].weights.push_back(weight / num_fits[n]);
    }
  }
}

Gradients GradientRecovery::gradients(const Eigen::Ref<const NodalVector>& u) const {
  Gradients gradients(9, weights_.size());
  for (Eigen::Index point = 0; point < gradients.cols(); ++point) {
    const Index* nodes = mesh_nodes_.data() + point / points_per_cell_ * nodes_per_cell_;
    Mat3 transposed = Mat3::Zero();
    for (int a = 0; a < nodes_per_cell_; ++a) {
      transposed += shape_gradients_.col(point * nodes_per_cell_ + a) *
                    u.segment<3>(3 * Eigen::Index{nodes[a]}).transpose();
    }
    gradients.col(point) = Eigen::Map<const Vector9>(transposed.data());
  }
  return gradients;
}

Gradients GradientRecovery::recover(const Gradients& at_points) const {
  Gradients at_nodes(9, nodes_.size());
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const Node& node = nodes_[n];
    Vector9 sum = Vector9::Zero();
    for (std::size_t s = 0; s < node.points.size(); ++s) {
      sum += node.weights[s] * at_points.col(node.points[s]);
    }
    at_nodes.col(static_cast<Eigen::Index>(n)) = sum;
  }
  Gradients recovered(9, at_points.cols());
  for (Eigen::Index point = 0; point < recovered.cols(); ++point) {
    const Index* nodes = node_of_cell_.data() + point / points_per_cell_ * nodes_per_cell_;
    Vector9 sum = Vector9::Zero();
    for (int a = 0; a < nodes_per_cell_; ++a) {
      sum += shape_(a, point % points_per_cell_) * at_nodes.col(nodes[a]);
    }
    recovered.col(point) = sum;
  }
  return recovered;
}

}  // namespace palpate
