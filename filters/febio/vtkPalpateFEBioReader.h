// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateFEBioReader
 * @brief reads a body from FEBio's file
 *
 * Output: an unstructured grid of VTK_TETRA or VTK_QUADRATIC_TETRA in m, with the arrays that
 * vtkPalpateAssignMaterial and vtkPalpateSetBoundary give it, `RegionId` (int), the place of the
 * cell's domain in the file, and the field array `Regions` (string), the names of the domains.
 * Points and cells come in the order of their ids in the file. What is read and what is not:
 * vtkPalpateFEBioModel.h. Under MPI the result is whole on rank 0 and empty elsewhere.
 */
#pragma once

#include <string>

#include "PalpateFEBioModule.h"
#include "vtkUnstructuredGridAlgorithm.h"

class PALPATEFEBIO_EXPORT vtkPalpateFEBioReader : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpateFEBioReader* New();
  vtkTypeMacro(vtkPalpateFEBioReader, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The file.
  vtkSetStdStringFromCharMacro(FileName);
  vtkGetCharFromStdStringMacro(FileName);
  ///@}
  ///@{
  /// The units of the file: an index into vtkPalpateFEBioUnits::All(), or -1 for those that the
  /// file names.
  vtkSetMacro(Units, int);
  vtkGetMacro(Units, int);
  ///@}

protected:
  vtkPalpateFEBioReader();
  ~vtkPalpateFEBioReader() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateFEBioReader(const vtkPalpateFEBioReader&) = delete;
  void operator=(const vtkPalpateFEBioReader&) = delete;

  std::string FileName;
  int Units = -1;
};
