// SPDX-License-Identifier: BSD-3-Clause
#include "linear/eigen_backend.h"

#include <Eigen/SparseCholesky>
#include <utility>

#include "linear/product.h"

namespace palpate {
namespace {

class EigenBackend final : public Backend {
 public:
  [[nodiscard]] const char* name() const override { return "Eigen LDLT"; }
  [[nodiscard]] bool pivots() const override { return false; }

  void analyse(std::shared_ptr<const SymmetricPattern> pattern) override {
    pattern_ = std::move(pattern);
    ldlt_ = std::make_unique<Ldlt>();
    const std::vector<double> ones(pattern_->num_values(), 1.0);
    ldlt_->analyzePattern(lower_triangle(*pattern_, ones));
  }

  /// Eigen can neither be given an order nor copy its solver; the order depends on the pattern
  /// alone.
  [[nodiscard]] std::unique_ptr<Backend> another() const override {
    auto other = std::make_unique<EigenBackend>();
    if (pattern_ != nullptr) other->analyse(pattern_);
    return other;
  }

  Pivots factorise(const std::vector<double>& values) override {
    ldlt_->factorize(lower_triangle(*pattern_, values));
    if (ldlt_->info() != Eigen::Success) return {};
    const Eigen::ArrayXd pivots = ldlt_->vectorD().array();
    return {pivots.abs().minCoeff(), pivots.abs().maxCoeff(),
            static_cast<int>((pivots < 0).count())};
  }

  void solve(Eigen::Ref<Eigen::MatrixXd> columns) override {
    const Eigen::MatrixXd solution = ldlt_->solve(columns);
    columns = solution;
  }

  [[nodiscard]] std::int64_t factor_bytes() const override {
    const std::int64_t numbers = ldlt_->num_entries() + pattern_->size;
    return numbers * static_cast<std::int64_t>(sizeof(double));
  }

 private:
  struct Ldlt final
      : Eigen::SimplicialLDLT<Eigen::SparseMatrix<double, Eigen::ColMajor, Index>, Eigen::Lower> {
    /// The number of entries of L below its diagonal; known after the analysis.
    [[nodiscard]] std::int64_t num_entries() const { return m_matrix.nonZeros(); }
  };

  std::shared_ptr<const SymmetricPattern> pattern_;
  std::unique_ptr<Ldlt> ldlt_;
};

}  // namespace

std::unique_ptr<Backend> make_eigen_backend() { return std::make_unique<EigenBackend>(); }

}  // namespace palpate
