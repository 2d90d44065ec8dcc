// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateFEBioWriter
 * @brief writes a scene as FEBio's file, specification 4.0
 *
 * Input: a body with a material and a boundary, as vtkPalpateSetBoundary gives it; a cell array
 * `RegionId` or `Region` where it has regions. The file has the nodes, the tetrahedra, a part with
 * a material for each region and material, the set of nodes `Fixed` with a zero displacement, and
 * the set `Touchable`. Ids are those of VTK plus 1. If there would be more than MostParts parts,
 * there is one for each region and law, and parameters that vary in it are maps. Units are SI.
 * Numbers have all their digits. Density and Prony series are written. Properties that FEBio's file
 * has no place for are named in a warning, and a law with another energy than FEBio's is an error:
 * vtkPalpateFEBioLaw.h.
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

  /// The largest number of parts with a number for each parameter: so many still fit into the lists
  /// of FEBio Studio.
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
  /// Whether the present update comes from Write(). ParaView updates a writer once more after
  /// Write(), which must not write again.
  bool Writes = false;
};
