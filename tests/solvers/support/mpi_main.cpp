// SPDX-License-Identifier: BSD-3-Clause
// main() of the test programs that run on several ranks. A failure on any rank fails the run.
#include <gtest/gtest.h>

#include "solvers/support/communicators.h"
#ifdef PALPATE_WITH_MPI
#include <mpi.h>

#include "schedule/mpi_communicator.h"
#endif

namespace palpate::test {

std::unique_ptr<Communicator> make_world() {
#ifdef PALPATE_WITH_MPI
  const MPI_Comm world = MPI_COMM_WORLD;
  return make_mpi_communicator(&world);
#else
  return make_serial_communicator();
#endif
}

}  // namespace palpate::test

int main(int argc, char** argv) {
#ifdef PALPATE_WITH_MPI
  MPI_Init(&argc, &argv);
#endif
  testing::InitGoogleTest(&argc, argv);
  const int result = RUN_ALL_TESTS();
#ifdef PALPATE_WITH_MPI
  MPI_Finalize();
#endif
  return result;
}
