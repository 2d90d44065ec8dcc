// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateFEBioWriter
 * @brief writes a scene as FEBio's file, specification 4.0
 *
 * Input: a body with a material and a boundary, as vtkPalpateSetBoundary gives it; a cell array
 * `RegionId` or `Region` where it has regions. The file has the nodes, the tetrahedra, a part with
 * a material for each region and material, the set of nodes `Fixed` with a zero displacement, and
 * the set `Touchable`. Ids are those of VTK and 1. Where there are more than MostParts of them, a
 * part is for each region and law, and parameters that vary in it are maps. Units are SI. Numbers
 * have all their digits. Density and Prony series are written; what FEBio has no place for is named
 * in a warning, and what it computes from another energy is an error: vtkPalpateFEBioLaw.h.
 *
 * Under MPI the pieces of the body are joined by their global point ids, and rank 0 writes.
 */
#pragma once

#include <string>

#include "PalpateFEBioModule.h"
#include "vtkUnstructuredGridAlgorithm.h"

class PALPATEFEBIO_EXPORT vtkPalpateFEBioWriter : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkPalpateFEBioWriter* New();
  vtkTypeMacro(vtkPalpateFEBioWriter, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Parts with a number for each parameter: so many still fit into the lists of FEBio Studio.
  static constexpr int MostParts = 100;

  ///@{
  /// The file.
  vtkSetStdStringFromCharMacro(FileName);
  vtkGetCharFromStdStringMacro(FileName);
  ///@}

  /// Updates the input and writes the file.
  /// @returns 0 after an error.
  int Write();

protected:
  vtkPalpateFEBioWriter();
  ~vtkPalpateFEBioWriter() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateFEBioWriter(const vtkPalpateFEBioWriter&) = delete;
  void operator=(const vtkPalpateFEBioWriter&) = delete;

  std::string FileName;
  /// ParaView updates a writer once more after Write(), and that shall not write.
  bool Writes = false;
};
