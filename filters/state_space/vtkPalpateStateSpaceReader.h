// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateStateSpaceReader
 * @brief reads a state space from a .palpate file
 *
 * Output: as vtkPalpatePrecomputeStateSpace gives it, without the figures of the run but `FileName`
 * and `Complete`. The file need not be complete. Damaged parts are left out, with a warning, and
 * are named in the field array `LeftOut`. Under MPI the result is whole on rank 0 and empty
 * elsewhere.
 *
 * A space that is not complete grows with its file: once the file has changed, ParaView's window
 * reads it again, see GetNeedsUpdate(). A program that gives out a growing space replaces the file
 * by a whole new one each time.
 */
#pragma once

#include <filesystem>
#include <string>

#include "PalpateStateSpaceModule.h"
#include "vtkPartitionedDataSetCollectionAlgorithm.h"

class PALPATESTATESPACE_EXPORT vtkPalpateStateSpaceReader
  : public vtkPartitionedDataSetCollectionAlgorithm
{
public:
  static vtkPalpateStateSpaceReader* New();
  vtkTypeMacro(vtkPalpateStateSpaceReader, vtkPartitionedDataSetCollectionAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The file.
  vtkSetStdStringFromCharMacro(FileName);
  vtkGetCharFromStdStringMacro(FileName);
  ///@}
  ///@{
  /// Largest error of the displacement that is carried for touching, as a share of the largest.
  vtkSetMacro(DisplacementBound, double);
  vtkGetMacro(DisplacementBound, double);
  ///@}

  /// Whether there is more in the file than was read, and nobody is writing to it. Then the next
  /// update reads it, on all ranks. ParaView's window asks rank 0 now and then (the hint
  /// LiveSource).
  bool GetNeedsUpdate();

protected:
  vtkPalpateStateSpaceReader();
  ~vtkPalpateStateSpaceReader() override;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateStateSpaceReader(const vtkPalpateStateSpaceReader&) = delete;
  void operator=(const vtkPalpateStateSpaceReader&) = delete;

  std::string FileName;
  double DisplacementBound = 1e-3;

  /// The time at which the file that was read last had been written.
  std::filesystem::file_time_type Written;
};
