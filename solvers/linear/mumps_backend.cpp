// SPDX-License-Identifier: BSD-3-Clause
#include "linear/mumps_backend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/memory_error.h"
#include "linear/blas.h"
#include "linear/mumps_team.h"
#include "linear/ordering.h"

namespace palpate {
namespace {

/// The errors of MUMPS (INFOG(1)) that are handled.
constexpr int kSingular = -10;
constexpr int kWorkArrayTooSmall = -9;
constexpr int kIntegerArrayTooSmall = -8;

/// Additional work space beyond which a factorisation is given up, in percent of the estimate.
constexpr int kMostWorkspacePercent = 2000;

void start_mpi_if_needed() {
  int initialised = 0;
  MPI_Initialized(&initialised);
  if (initialised != 0) return;
  int provided = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &provided) != MPI_SUCCESS) {
    throw BackendError("MPI, which MUMPS needs, could not be started.");
  }
  std::atexit([] {
    int finalised = 0;
    MPI_Finalized(&finalised);
    if (finalised == 0) MPI_Finalize();
  });
}

/// The data that the factors of one pattern share.
struct Plan {
  MUMPS_INT size = 0;
  /// Row and column of each value, counted from 1.
  std::vector<MUMPS_INT> rows;
  std::vector<MUMPS_INT> columns;
  /// The position of each unknown in the order of elimination, counted from 1.
  std::vector<MUMPS_INT> order;
};

Plan make_plan(const SymmetricPattern& pattern) {
  Plan plan;
  plan.size = pattern.size;
  plan.rows.reserve(pattern.num_values());
  plan.columns.reserve(pattern.num_values());
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      plan.rows.push_back(pattern.row[i] + 1);
      plan.columns.push_back(c + 1);
    }
  }
  for (Index place : nested_dissection(pattern)) plan.order.push_back(place + 1);
  return plan;
}

/// @tparam Mumps DMUMPS_STRUC_C or SMUMPS_STRUC_C.
/// @tparam Real The type of its numbers.
template <class Mumps, class Real>
class MumpsBackend final : public Backend {
 public:
  explicit MumpsBackend(std::shared_ptr<MumpsTeam> team)
      : team_(std::move(team)), instance_(team_->new_instance()) {
    prepare_blas();
    mumps_.par = 1;
    mumps_.sym = 2;
    run(kInitialise, "start");
    for (int stream : {1, 2, 3}) icntl(stream) = -1;
    icntl(4) = 0;    // prints nothing
    icntl(7) = 1;    // the order is given
    icntl(6) = 0;    // no permutation by values: they are not known at the analysis
    icntl(8) = 0;    // no scaling: the matrix comes scaled
    icntl(10) = 0;   // no iterative refinement: Newton steps refine
    icntl(12) = 1;   // usual ordering of a symmetric matrix
    icntl(13) = 1;   // the root is factorised by one process: inertia is exact
    icntl(14) = 30;  // workspace beyond the estimate, %
    icntl(24) = 0;   // small pivots are not replaced: the caller judges them
  }

  ~MumpsBackend() override { team_->run(kTerminate, instance_, mumps_); }

  MumpsBackend(const MumpsBackend&) = delete;
  MumpsBackend& operator=(const MumpsBackend&) = delete;

  [[nodiscard]] const char* name() const override { return "MUMPS"; }
  [[nodiscard]] bool pivots() const override { return true; }

  void analyse(std::shared_ptr<const SymmetricPattern> pattern) override {
    take(std::make_shared<const Plan>(make_plan(*pattern)));
  }

  [[nodiscard]] std::unique_ptr<Backend> another() const override {
    auto other = std::make_unique<MumpsBackend>(team_);
    if (plan_ != nullptr) other->take(plan_);
    return other;
  }

  [[nodiscard]] std::unique_ptr<Backend> in_single_precision() const override {
    auto other = std::make_unique<MumpsBackend<SMUMPS_STRUC_C, float>>(team_);
    if (plan_ != nullptr) other->take(plan_);
    return other;
  }

  void take(std::shared_ptr<const Plan> plan) {
    plan_ = std::move(plan);
    is_analysed_ = false;
    mumps_.n = plan_->size;
    mumps_.nnz = static_cast<MUMPS_INT8>(plan_->rows.size());
    // MUMPS only reads these arrays, but its C interface is not const.
    mumps_.irn = const_cast<MUMPS_INT*>(plan_->rows.data());       // NOLINT
    mumps_.jcn = const_cast<MUMPS_INT*>(plan_->columns.data());    // NOLINT
    mumps_.perm_in = const_cast<MUMPS_INT*>(plan_->order.data());  // NOLINT
  }

  Pivots factorise(const std::vector<double>& values) override {
    analyse_once();
    if constexpr (std::is_same_v<Real, double>) {
      mumps_.a = const_cast<double*>(values.data());  // NOLINT: read only, but the interface is C
    } else {
      values_.assign(values.begin(), values.end());
      mumps_.a = values_.data();
    }
    for (;;) {
      team_->run(kFactorise, instance_, mumps_);
      const int error = mumps_.infog[0];
      // RINFOG(19), RINFOG(21): the least and the greatest pivot; INFOG(12): negative ones.
      if (error >= 0) return {mumps_.rinfog[18], mumps_.rinfog[20], mumps_.infog[11]};
      if (error == kSingular) return {};
      const bool workspace = error == kWorkArrayTooSmall || error == kIntegerArrayTooSmall;
      if (!workspace || icntl(14) > kMostWorkspacePercent) fail("factorise");
      icntl(14) *= 2;
    }
  }

  void solve(Eigen::Ref<Eigen::MatrixXd> columns) override {
    mumps_.nrhs = static_cast<MUMPS_INT>(columns.cols());
    icntl(27) = mumps_.nrhs;
    if constexpr (std::is_same_v<Real, double>) {
      mumps_.rhs = columns.data();
      mumps_.lrhs = static_cast<MUMPS_INT>(columns.outerStride());
      run(kSolve, "solve with");
    } else {
      // Each column is scaled by a power of two, since residuals may be too small for single
      // precision.
      Eigen::RowVectorXd scale(columns.cols());
      for (Eigen::Index c = 0; c < columns.cols(); ++c) {
        scale[c] = std::ldexp(1.0, std::ilogb(columns.col(c).template lpNorm<Eigen::Infinity>()));
        if (!(scale[c] > 0 && std::isfinite(scale[c]))) scale[c] = 1;
      }
      columns_ = (columns * scale.cwiseInverse().asDiagonal()).template cast<Real>();
      mumps_.rhs = columns_.data();
      mumps_.lrhs = static_cast<MUMPS_INT>(columns_.rows());
      run(kSolve, "solve with");
      columns = columns_.template cast<double>() * scale.asDiagonal();
    }
  }

  [[nodiscard]] std::int64_t factor_bytes() const override {
    // INFOG(20) is the expected number and INFOG(29) the actual one; below zero they count
    // millions.
    analyse_once();
    const std::int64_t entries = mumps_.infog[28] != 0 ? mumps_.infog[28] : mumps_.infog[19];
    return (entries < 0 ? -1'000'000 * entries : entries) * static_cast<std::int64_t>(sizeof(Real));
  }

 private:
  MUMPS_INT& icntl(int number) { return mumps_.icntl[number - 1]; }

  /// Which of several instances for a pattern are used, and in which precision, is known only when
  /// they have something to factorise.
  void analyse_once() const {
    if (is_analysed_) return;
    run(kAnalyse, "analyse the pattern of");
    is_analysed_ = true;
  }

  void run(MumpsJob job, const char* what) const {
    team_->run(job, instance_, mumps_);
    if (mumps_.infog[0] < 0) fail(what);
  }

  [[noreturn]] void fail(const char* what) const {
    // Real or integer arrays of the analysis, and any other array.
    constexpr std::array<MUMPS_INT, 3> kOutOfMemory = {-5, -7, -13};
    if (std::count(kOutOfMemory.begin(), kOutOfMemory.end(), mumps_.infog[0]) > 0) {
      const std::string purpose = "for MUMPS to " + std::string(what) + " a matrix of " +
                                  std::to_string(mumps_.n) + " unknowns";
      throw MemoryError(not_enough_memory(purpose.c_str()));
    }
    throw BackendError("MUMPS could not " + std::string(what) + " a matrix of " +
                       std::to_string(mumps_.n) +
                       " unknowns: INFOG(1) = " + std::to_string(mumps_.infog[0]) +
                       ", INFOG(2) = " + std::to_string(mumps_.infog[1]) + '.');
  }

  std::shared_ptr<MumpsTeam> team_;
  int instance_;
  /// MUMPS keeps its factors in it.
  mutable Mumps mumps_{};
  mutable bool is_analysed_ = false;
  std::shared_ptr<const Plan> plan_;
  /// Arrays for MUMPS in single precision.
  std::vector<Real> values_;
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> columns_;
};

}  // namespace

std::unique_ptr<Backend> make_mumps_backend() {
  start_mpi_if_needed();
  return make_mumps_backend(std::make_shared<MumpsTeam>(MPI_COMM_SELF));
}

std::unique_ptr<Backend> make_mumps_backend(std::shared_ptr<MumpsTeam> team) {
  return std::make_unique<MumpsBackend<DMUMPS_STRUC_C, double>>(std::move(team));
}

}  // namespace palpate
