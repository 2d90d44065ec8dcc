// SPDX-License-Identifier: BSD-3-Clause
#include "linear/mumps_team.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <map>
#include <thread>
#include <type_traits>

namespace palpate {
namespace {

/// The time that a rank sleeps between two looks for an order. It is short compared with a job of a
/// body that is worth a group, and leaves the core free meanwhile (MPI itself polls without
/// sleeping).
constexpr std::chrono::microseconds kNap(50);

bool mpi_has_ended() {
  int finalised = 0;
  MPI_Finalized(&finalised);
  return finalised != 0;
}

}  // namespace

struct MumpsTeam::Order {
  bool release = false;
  MumpsJob job = kTerminate;
  int instance = 0;
  bool single = false;
  MUMPS_INT icntl[60] = {};
  double cntl[15] = {};
};

MumpsTeam::MumpsTeam(MPI_Comm comm) {
  if (comm != MPI_COMM_SELF) MPI_Comm_dup(comm, &comm_);
  MPI_Comm_rank(comm_, &rank_);
  MPI_Comm_size(comm_, &size_);
}

MumpsTeam::~MumpsTeam() {
  if (mpi_has_ended()) return;
  if (rank_ == 0) {
    Order order;
    order.release = true;
    send(order);
  }
  if (comm_ != MPI_COMM_SELF) MPI_Comm_free(&comm_);
}

template <class Mumps>
void MumpsTeam::run_any(MumpsJob job, int instance, Mumps& mumps) {
  if (mpi_has_ended()) return;  // the object has outlived main()
  Order order;
  order.job = job;
  order.instance = instance;
  order.single = std::is_same_v<Mumps, SMUMPS_STRUC_C>;
  std::copy(std::begin(mumps.icntl), std::end(mumps.icntl), order.icntl);
  std::copy(std::begin(mumps.cntl), std::end(mumps.cntl), order.cntl);
  send(order);
  mumps.job = job;
  mumps.comm_fortran = static_cast<MUMPS_INT>(MPI_Comm_c2f(comm_));
  call_mumps(mumps);
}

void MumpsTeam::run(MumpsJob job, int instance, DMUMPS_STRUC_C& mumps) {
  run_any(job, instance, mumps);
}

void MumpsTeam::run(MumpsJob job, int instance, SMUMPS_STRUC_C& mumps) {
  run_any(job, instance, mumps);
}

void MumpsTeam::serve() {
  std::map<int, DMUMPS_STRUC_C> double_instances;
  std::map<int, SMUMPS_STRUC_C> single_instances;
  const auto obey = [this](const Order& order, auto& instances) {
    if (order.job == kInitialise) {
      auto& fresh = instances[order.instance] = {};
      fresh.sym = 2;
      fresh.par = 1;
      fresh.comm_fortran = static_cast<MUMPS_INT>(MPI_Comm_c2f(comm_));
    }
    auto& mumps = instances.at(order.instance);
    if (order.job != kInitialise) {  // initialisation sets the defaults
      std::copy(std::begin(order.icntl), std::end(order.icntl), mumps.icntl);
      std::copy(std::begin(order.cntl), std::end(order.cntl), mumps.cntl);
    }
    mumps.job = order.job;
    call_mumps(mumps);  // MUMPS reports an error to rank 0
    if (order.job == kTerminate) instances.erase(order.instance);
  };
  for (Order order = receive(); !order.release; order = receive()) {
    if (order.single) {
      obey(order, single_instances);
    } else {
      obey(order, double_instances);
    }
  }
}

void MumpsTeam::send(const Order& order) {
  static_assert(std::is_trivially_copyable_v<Order>);
  for (int rank = 1; rank < size_; ++rank) {
    MPI_Send(&order, sizeof order, MPI_BYTE, rank, 0, comm_);
  }
}

MumpsTeam::Order MumpsTeam::receive() {
  for (int there = 0; there == 0;) {
    MPI_Iprobe(0, 0, comm_, &there, MPI_STATUS_IGNORE);
    if (there == 0) std::this_thread::sleep_for(kNap);
  }
  Order order;
  MPI_Recv(&order, sizeof order, MPI_BYTE, 0, 0, comm_, MPI_STATUS_IGNORE);
  return order;
}

}  // namespace palpate
