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

/// By how much a fit may magnify what its points have, at the most. Where the points of a patch
/// hardly tell two polynomials apart, as in a few flat cells or in the parts of one divided cell,
/// the value of the fit is a difference of large numbers.
constexpr double kMostAmplification = 8;
/// How often a patch is grown for that.
constexpr int kGrowths = 2;

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

/// Values at places as weighted sums of the values at points.
struct Fit {
  std::vector<Index> points;
  /// [places × points].
  Eigen::MatrixXd weights;

  [[nodiscard]] double amplification() const {
    return weights.cwiseAbs().rowwise().sum().maxCoeff();
  }
};

/// Least squares by polynomials around the corners of a mesh.
class Fitting {
 public:
  /// @param points The quadrature points of each cell, cell by cell, `of_cell` each.
  Fitting(const TetMesh& mesh, const Patches& patches, const std::vector<Vec3>& points, int of_cell)
      : mesh_(mesh), patches_(patches), points_(points), of_cell_(of_cell) {}

  /// The polynomial around a corner, at nodes of the mesh: of the degree of the shape functions,
  /// or of a lower one where there are too few cells for it or they do not determine it.
  [[nodiscard]] Fit around(const Patches::Corner& corner, const std::set<Index>& nodes) const {
    for (int degree = static_cast<int>(mesh_.order);; --degree) {
      const int terms = kTermsOfDegree[degree];
      const auto enough = static_cast<std::size_t>(kPointsOfTerm * terms / of_cell_);
      std::set<Index> patch = patches_.grown(corner, enough);
      if (degree > 0 && patch.size() < enough) continue;
      for (int growth = 0; growth <= kGrowths; ++growth) {
        Fit fit = fitted(patch, mesh_.points[corner.second], nodes, terms);
        if (degree == 0 || fit.amplification() <= kMostAmplification) return fit;
        patch = patches_.grown(corner, patch.size() + 1);
      }
    }
  }

 private:
  [[nodiscard]] Fit fitted(const std::set<Index>& patch, const Vec3& centre,
                           const std::set<Index>& nodes, int terms) const {
    double extent = 0;
    for (const Index c : patch) {
      for (int a = 0; a < 4; ++a) {
        extent = std::max(extent, (mesh_.points[mesh_.cell(c)[a]] - centre).norm());
      }
    }
    Fit fit;
    for (const Index c : patch) {
      for (int q = 0; q < of_cell_; ++q) fit.points.push_back(c * of_cell_ + q);
    }
    const auto of = [&](const Vec3& x) { return monomials((x - centre) / extent, terms); };
    Eigen::MatrixXd at_points(fit.points.size(), terms);
    for (Eigen::Index row = 0; row < at_points.rows(); ++row) {
      at_points.row(row) = of(points_[fit.points[static_cast<std::size_t>(row)]]).transpose();
    }
    Eigen::MatrixXd at_nodes(nodes.size(), terms);
    Eigen::Index row = 0;
    for (const Index node : nodes) at_nodes.row(row++) = of(mesh_.points[node]).transpose();
    fit.weights = at_nodes * at_points.completeOrthogonalDecomposition().pseudoInverse();
    return fit;
  }

  const TetMesh& mesh_;
  const Patches& patches_;
  const std::vector<Vec3>& points_;
  int of_cell_;
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
  const Fitting fitting(mesh, patches, places_, points_per_cell_);
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

  for (const auto& [corner, around] : patches.cells()) {
    std::set<Index> fitted{corner.second};
    for (const Index c : around) {
      for (int e = 4; e < nodes_per_cell_; ++e) {
        const auto& edge = kTetEdges[e - 4];
        if (mesh.cell(c)[edge[0]] == corner.second || mesh.cell(c)[edge[1]] == corner.second) {
          fitted.insert(mesh.cell(c)[e]);
        }
      }
    }
    const Fit fit = fitting.around(corner, fitted);
    Eigen::Index row = 0;
    for (const Index point : fitted) {
      const Index node = numbers.at({corner.first, point});
      ++num_fits[node];
      for (std::size_t s = 0; s < fit.points.size(); ++s) {
        weights[node][fit.points[s]] += fit.weights(row, static_cast<Eigen::Index>(s));
      }
      ++row;
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
