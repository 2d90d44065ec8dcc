// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateEstimateError
 * @brief how far the interpolated force may be off around each check-point of a state space
 *
 * Input: a state space (see vtkPalpateStateSpace.h). Output: the same with the point array
 * `EstimatedError` of `Configurations`, N: the largest estimate of the cells around the check-point
 * (see solvers/interpolation/error_estimate.h), from the space alone. NaN where there is too little
 * to estimate it by, and at levels above the first.
 */
#pragma once

#include "PalpateStateSpaceModule.h"
#include "vtkPartitionedDataSetCollectionAlgorithm.h"

class PALPATESTATESPACE_EXPORT vtkPalpateEstimateError
  : public vtkPartitionedDataSetCollectionAlgorithm
{
public:
  static vtkPalpateEstimateError* New();
  vtkTypeMacro(vtkPalpateEstimateError, vtkPartitionedDataSetCollectionAlgorithm);

protected:
  vtkPalpateEstimateError();
  ~vtkPalpateEstimateError() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateEstimateError(const vtkPalpateEstimateError&) = delete;
  void operator=(const vtkPalpateEstimateError&) = delete;
};
