// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateCommunicator.h"

#ifdef PALPATE_WITH_MPI
#  include "schedule/mpi_communicator.h"
#  include "vtkMPI.h"
#  include "vtkMPICommunicator.h"
#endif
#include "vtkMultiProcessController.h"

const void* vtkPalpateMpiComm([[maybe_unused]] vtkMultiProcessController* controller)
{
#ifdef PALPATE_WITH_MPI
  auto* mpi =
    controller ? vtkMPICommunicator::SafeDownCast(controller->GetCommunicator()) : nullptr;
  if (mpi && mpi->GetMPIComm())
  {
    return mpi->GetMPIComm()->GetHandle();
  }
#endif
  return nullptr;
}

std::unique_ptr<palpate::Communicator> vtkPalpateCommunicator(
  [[maybe_unused]] vtkMultiProcessController* controller)
{
#ifdef PALPATE_WITH_MPI
  if (const void* comm = vtkPalpateMpiComm(controller))
  {
    return palpate::make_mpi_communicator(comm);
  }
#endif
  return palpate::make_serial_communicator();
}
