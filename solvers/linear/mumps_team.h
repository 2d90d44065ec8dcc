// SPDX-License-Identifier: BSD-3-Clause
// Ranks that run the jobs of MUMPS together. Rank 0 decides, and the others wait for its orders.
#pragma once

#include <dmumps_c.h>
#include <mpi.h>
#include <smumps_c.h>

#include <memory>

namespace palpate {

class Backend;

/// Jobs of the MUMPS interface.
enum MumpsJob { kInitialise = -1, kTerminate = -2, kAnalyse = 1, kFactorise = 2, kSolve = 3 };

inline void call_mumps(DMUMPS_STRUC_C& mumps) { dmumps_c(&mumps); }
inline void call_mumps(SMUMPS_STRUC_C& mumps) { smumps_c(&mumps); }

class MumpsTeam {
 public:
  /// @note Collective. The communicator is duplicated, unless it is MPI_COMM_SELF.
  explicit MumpsTeam(MPI_Comm comm);
  /// On rank 0, the destructor releases the other ranks.
  ~MumpsTeam();
  MumpsTeam(const MumpsTeam&) = delete;
  MumpsTeam& operator=(const MumpsTeam&) = delete;

  /// Call this on rank 0. It returns the number of a new instance of MUMPS.
  [[nodiscard]] int new_instance() { return num_instances_++; }
  /// Call this on rank 0. It runs a job of an instance on all ranks, with its control parameters.
  void run(MumpsJob job, int instance, DMUMPS_STRUC_C& mumps);
  /// Runs a job of an instance in single precision.
  void run(MumpsJob job, int instance, SMUMPS_STRUC_C& mumps);

  /// Call this on the other ranks. They execute the orders of rank 0 until it releases them.
  void serve();

 private:
  struct Order;
  template <class Mumps>
  void run_any(MumpsJob job, int instance, Mumps& mumps);
  void send(const Order& order);
  [[nodiscard]] Order receive();

  MPI_Comm comm_ = MPI_COMM_SELF;
  int rank_ = 0;
  int size_ = 1;
  int num_instances_ = 0;
};

/// Makes a backend as make_mumps_backend() does, for rank 0 of a team.
[[nodiscard]] std::unique_ptr<Backend> make_mumps_backend(std::shared_ptr<MumpsTeam> team);

}  // namespace palpate
