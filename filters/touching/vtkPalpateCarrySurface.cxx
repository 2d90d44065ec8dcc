// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateCarrySurface.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "schedule/communicator.h"
#include "state_space/surface.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateDisplaySurface.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

struct vtkPalpateCarrySurface::Prepared
{
  vtkPalpateDisplaySurface Display;
  /// The surface of the body, on rank 0.
  palpate::Surface Surface;

  /// Fills the output with the surface of the body and its point arrays.
  void TakeArrays(vtkUnstructuredGrid* body, vtkPolyData* output) const
  {
    output->GetFieldData()->ShallowCopy(body->GetFieldData());
    vtkPointData* arrays = body->GetPointData();
    for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
    {
      vtkDataArray* array = arrays->GetArray(i);
      if (!array)
      {
        continue;
      }
      vtkNew<vtkDoubleArray> ofSurface;
      ofSurface->SetName(array->GetName());
      ofSurface->SetNumberOfComponents(array->GetNumberOfComponents());
      ofSurface->SetNumberOfTuples(this->Surface.num_points());
      for (vtkIdType p = 0; p < this->Surface.num_points(); ++p)
      {
        ofSurface->SetTuple(p, this->Surface.mesh_points[static_cast<std::size_t>(p)], array);
      }
      output->GetPointData()->AddArray(ofSurface);
    }
  }
};

vtkStandardNewMacro(vtkPalpateCarrySurface);

vtkPalpateCarrySurface::vtkPalpateCarrySurface()
  : Cache(std::make_unique<Prepared>())
{
  this->SetNumberOfInputPorts(2);
}

vtkPalpateCarrySurface::~vtkPalpateCarrySurface() = default;

int vtkPalpateCarrySurface::FillInputPortInformation(int port, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, port == 0 ? "vtkUnstructuredGrid" : "vtkPolyData");
  return 1;
}

int vtkPalpateCarrySurface::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkPolyData::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&](palpate::Communicator& ranks)
    {
      auto* input = vtkPalpateInput<vtkUnstructuredGrid>(inputVector[0]);
      // Frames of a motion share points and cells.
      const vtkMTimeType bodyTime = input && input->GetPoints()
        ? std::max(input->GetPoints()->GetMTime(), input->GetCells()->GetMTime())
        : 0;
      // On rank 0 alone.
      vtkSmartPointer<vtkUnstructuredGrid> body;
      bool passesOn = false;
      palpate::agree(ranks,
        [&]
        {
          body = vtkPalpateGatherBody(input, controller);
          passesOn = body && vtkPalpatePassFailure(body, output);
          if (body && !passesOn && !body->GetPointData()->GetArray(vtkPalpateArray::Displacement))
          {
            throw palpate::InputError("The body has no point array Displacement. Connect the "
                                      "output of Solve Equilibrium, Solve Dynamics or Simulate "
                                      "Touch, or a body with such an array (m).");
          }
        });
      if (palpate::any(ranks, passesOn))
      {
        return;
      }
      const auto carrier = [&]
      {
        palpate::Scene scene;
        scene.body.mesh = vtkPalpateMeshFromGrid(body);
        palpate::check_and_orient(scene.body.mesh);
        vtkPalpateReadBoundary(body, scene);
        this->Cache->Surface = palpate::make_surface(scene.body);
        return vtkPalpateDisplaySurface::Carrier{ this->Cache->Surface, {} };
      };
      this->Cache->Display.Take(this, inputVector[1], bodyTime, controller, ranks, carrier);
      palpate::agree(ranks,
        [&]
        {
          if (this->Cache->Display.IsGiven())
          {
            this->Cache->TakeArrays(body, output);
            this->Cache->Display.Follow(output);
          }
        });
    });
  return 1;
}

void vtkPalpateCarrySurface::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}
