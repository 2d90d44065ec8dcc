// SPDX-License-Identifier: BSD-3-Clause
#include "filters/scene/read_body.h"

#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkPalpateScene.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLUnstructuredGridReader.h"

palpate::Body ReadBody(const std::string& file) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  vtkUnstructuredGrid* grid = reader->GetOutput();
  palpate::Body body;
  body.mesh = vtkPalpateMeshFromGrid(grid);
  vtkDataArray* fixed = grid->GetPointData()->GetArray(vtkPalpateArray::Fixed);
  for (vtkIdType p = 0; p < fixed->GetNumberOfTuples(); ++p) {
    body.fixed.push_back(fixed->GetTuple1(p) != 0 ? 1 : 0);
  }
  body.touchable = vtkPalpateTouchableSurface(body.mesh, body.fixed);
  return body;
}
