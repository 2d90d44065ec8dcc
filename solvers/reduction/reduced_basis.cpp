// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/reduced_basis.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "assembly/supports.h"

namespace palpate {
namespace {

/// A direction with less than this share of the energy of the fields is rounding.
constexpr double kIndependent = 1e-13;

}  // namespace

RestStiffness::RestStiffness(const Assembly& assembly, const NodalVector& rest,
                             const PointMatrix* springs)
    : state_of_unknown_(assembly.state_of_unknown()) {
  NodalVector state = NodalVector::Zero(assembly.state_size());
  state.head(rest.size()) = rest;
  NodalVector force;
  std::vector<double> values;
  (void)assembly.tangent(state, force, values);
  if (springs != nullptr) springs->add_to(1, values);
  const SymmetricPattern& pattern = assembly.pattern();
  matrix_ = Eigen::Map<const Eigen::SparseMatrix<double>>(
      pattern.size, pattern.size, pattern.num_values(), pattern.column_start.data(),
      pattern.row.data(), values.data());
}

Eigen::MatrixXd RestStiffness::times(const Eigen::MatrixXd& x) const {
  const auto size = static_cast<Eigen::Index>(state_of_unknown_.size());
  Eigen::MatrixXd unknowns(size, x.cols());
  for (Eigen::Index i = 0; i < size; ++i) unknowns.row(i) = x.row(state_of_unknown_[i]);
  const Eigen::MatrixXd products = matrix_.selfadjointView<Eigen::Lower>() * unknowns;
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(x.rows(), x.cols());
  for (Eigen::Index i = 0; i < size; ++i) result.row(state_of_unknown_[i]) = products.row(i);
  return result;
}

void hold_directions(const Body& body, Eigen::MatrixXd& basis) {
  for (std::size_t p = 0; p < body.held_directions.size(); ++p) {
    if (body.held_directions[p].isZero(0)) continue;
    auto rows = basis.middleRows<3>(3 * static_cast<Eigen::Index>(p));
    rows = (projector(body.held_directions[p]) * rows).eval();
  }
}

ModeBuilder::ModeBuilder(const RestStiffness& stiffness, Eigen::Index num_rows)
    : stiffness_(stiffness), modes_(num_rows, 0), of_modes_(num_rows, 0) {}

void ModeBuilder::add(Eigen::MatrixXd fields, Eigen::Index most) {
  if (fields.cols() == 0 || most <= 0) return;
  const double energy_before = fields.cwiseProduct(stiffness_.times(fields)).colwise().sum().sum();
  fields -= modes_ * (of_modes_.transpose() * fields);
  const Eigen::MatrixXd gram = fields.transpose() * stiffness_.times(fields);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(0.5 * (gram + gram.transpose()));
  // Eigenvalues are in ascending order.
  const Eigen::VectorXd energies = solver.eigenvalues().reverse();
  const Eigen::Index count =
      std::min<Eigen::Index>(most, (energies.array() > kIndependent * energy_before).count());
  Eigen::MatrixXd added = fields * solver.eigenvectors().rightCols(count).rowwise().reverse();
  for (Eigen::Index c = 0; c < count; ++c) added.col(c) /= std::sqrt(energies[c]);
  // Remove what rounding has left along the other modes, and along each other.
  added -= modes_ * (of_modes_.transpose() * added);
  const Eigen::LLT<Eigen::MatrixXd> factor(added.transpose() * stiffness_.times(added));
  factor.matrixU().solveInPlace<Eigen::OnTheRight>(added);
  const Eigen::Index n = modes_.cols();
  modes_.conservativeResize(Eigen::NoChange, n + count);
  modes_.rightCols(count) = added;
  of_modes_.conservativeResize(Eigen::NoChange, n + count);
  of_modes_.rightCols(count) = stiffness_.times(added);
}

Eigen::MatrixXd ModeBuilder::coordinates(const Eigen::MatrixXd& x) const {
  return of_modes_.transpose() * x;
}

}  // namespace palpate
