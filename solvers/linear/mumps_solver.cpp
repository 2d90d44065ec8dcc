// SPDX-License-Identifier: BSD-3-Clause
#include "linear/mumps_solver.h"

#include <dlfcn.h>
#include <dmumps_c.h>
#include <mpi.h>

#include <cstdlib>

#include "base/error.h"

namespace palpate {
namespace {

/// Jobs of the MUMPS interface.
enum Job { kInitialise = -1, kTerminate = -2, kAnalyse = 1, kFactorise = 2, kSolve = 3 };

/// MUMPS errors (INFOG(1)) that we meet with sense.
constexpr int kSingular = -10;
constexpr int kWorkArrayTooSmall = -9;
constexpr int kIntegerArrayTooSmall = -8;

/// A pivot is null when its row is below this share of the matrix's norm, scaled to a unit diagonal.
/// Rounding leaves 1e-16 to 1e-15 there; regular bodies, with a contrast of moduli of 1e6 too, have
/// pivots above 1e-10.
constexpr double kNullPivot = 1e-13;

/// Share of additional workspace that is given up on, in percent of the estimate.
constexpr int kMostWorkspacePercent = 2000;

/// METIS. PORD is faster by a sixth on bodies of a few thousand unknowns, but ends the process on
/// some small graphs ("no valid number of stages in multisector").
constexpr int kOrdering = 5;

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

/// The ranks are the parallelism: threads of the BLAS under each would fight for the cores.
void keep_blas_to_one_thread() {
  if (void* set_threads = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) {
    reinterpret_cast<void (*)(int)>(set_threads)(1);
  }
}

class MumpsSolver final : public LinearSolver {
 public:
  MumpsSolver() {
    start_mpi_if_needed();
    keep_blas_to_one_thread();
    mumps_.comm_fortran = static_cast<MUMPS_INT>(MPI_Comm_c2f(MPI_COMM_SELF));
    mumps_.par = 1;
    mumps_.sym = 2;
    run(kInitialise, "start");
    for (int stream : {1, 2, 3}) icntl(stream) = -1;
    icntl(4) = 0;    // prints nothing
    icntl(7) = kOrdering;
    icntl(6) = 0;    // no permutation by values: they are not known at the analysis
    icntl(8) = 1;    // scaling by the diagonal
    icntl(10) = 0;   // no iterative refinement: Newton is one
    icntl(12) = 1;   // usual ordering of a symmetric matrix
    icntl(13) = 1;   // the root is factorised by one process: inertia is exact
    icntl(14) = 30;  // workspace beyond the estimate, %
    icntl(24) = 1;   // null pivots are counted: else rounding may hide a singular matrix
    mumps_.cntl[2] = kNullPivot;
  }

  ~MumpsSolver() override {
    int finalised = 0;
    MPI_Finalized(&finalised);
    if (finalised != 0) return;
    mumps_.job = kTerminate;
    dmumps_c(&mumps_);
  }

  MumpsSolver(const MumpsSolver&) = delete;
  MumpsSolver& operator=(const MumpsSolver&) = delete;

  [[nodiscard]] const char* name() const override { return "MUMPS"; }

  void analyse(const SymmetricPattern& pattern) override {
    rows_.clear();
    columns_.clear();
    rows_.reserve(pattern.num_values());
    columns_.reserve(pattern.num_values());
    for (Index c = 0; c < pattern.size; ++c) {
      for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
        rows_.push_back(pattern.row[i] + 1);
        columns_.push_back(c + 1);
      }
    }
    mumps_.n = pattern.size;
    mumps_.nnz = pattern.num_values();
    mumps_.irn = rows_.data();
    mumps_.jcn = columns_.data();
    run(kAnalyse, "analyse the pattern of");
  }

  FactorStatus factorise(const std::vector<double>& values) override {
    mumps_.a = const_cast<double*>(values.data());  // NOLINT: read only, but the interface is C
    for (;;) {
      mumps_.job = kFactorise;
      dmumps_c(&mumps_);
      const int error = mumps_.infog[0];
      if (error >= 0) return mumps_.infog[27] > 0 ? FactorStatus::singular : FactorStatus::ok;
      if (error == kSingular) return FactorStatus::singular;
      const bool workspace = error == kWorkArrayTooSmall || error == kIntegerArrayTooSmall;
      if (!workspace || icntl(14) > kMostWorkspacePercent) fail("factorise");
      icntl(14) *= 2;
    }
  }

  void solve(Eigen::Ref<Eigen::MatrixXd> columns) override {
    mumps_.rhs = columns.data();
    mumps_.nrhs = static_cast<MUMPS_INT>(columns.cols());
    mumps_.lrhs = static_cast<MUMPS_INT>(columns.outerStride());
    icntl(27) = mumps_.nrhs;
    run(kSolve, "solve with");
  }

  [[nodiscard]] int negative_pivots() const override { return mumps_.infog[11]; }

 private:
  MUMPS_INT& icntl(int number) { return mumps_.icntl[number - 1]; }

  void run(Job job, const char* what) {
    mumps_.job = job;
    dmumps_c(&mumps_);
    if (mumps_.infog[0] < 0) fail(what);
  }

  [[noreturn]] void fail(const char* what) const {
    throw BackendError("MUMPS could not " + std::string(what) + " a matrix of " +
                       std::to_string(mumps_.n) + " unknowns: INFOG(1) = " +
                       std::to_string(mumps_.infog[0]) + ", INFOG(2) = " +
                       std::to_string(mumps_.infog[1]) +
                       (mumps_.infog[0] == -13 ? " (out of memory)." : "."));
  }

  DMUMPS_STRUC_C mumps_{};
  std::vector<MUMPS_INT> rows_;
  std::vector<MUMPS_INT> columns_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_mumps_solver() { return std::make_unique<MumpsSolver>(); }

}  // namespace palpate
