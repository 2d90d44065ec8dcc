// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTouchReducedModel.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/memory_error.h"
#include "schedule/communicator.h"
#include "state_space/surface.h"
#include "vtkCellArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateDisplaySurface.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFrameTimes.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateReducedModel.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateTouchedSurface.h"
#include "vtkPalpateWholeBody.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

struct vtkPalpateTouchReducedModel::Prepared
{
  vtkMTimeType InputTime = 0;
  /// Null where a filter before could not make the body, and on all ranks but the first.
  vtkSmartPointer<vtkUnstructuredGrid> Body;
  palpate::Surface Surface;
  vtkNew<vtkCellArray> Triangles;
  /// (Φ, L) of the points of the surface [3 points × coordinates].
  Eigen::MatrixXf Basis;
  /// The displacement at rest from which the coordinates count [3 points], m.
  Eigen::VectorXf Rest;

  void Take(const vtkSmartPointer<vtkUnstructuredGrid>& body)
  {
    const vtkPalpateReducedModel reduced = vtkPalpateReadReducedModel(body);
    palpate::TetMesh mesh = vtkPalpateMeshFromGrid(body);
    palpate::check_and_orient(mesh);
    this->Surface = palpate::make_surface(mesh);
    this->Basis.resize(3 * this->Surface.num_points(), reduced.Basis.cols());
    this->Rest.resize(3 * this->Surface.num_points());
    for (palpate::Index p = 0; p < this->Surface.num_points(); ++p)
    {
      const palpate::Index point = this->Surface.mesh_points[static_cast<std::size_t>(p)];
      this->Basis.middleRows<3>(3 * p) = reduced.Basis.middleRows<3>(3 * point).cast<float>();
      this->Rest.segment<3>(3 * p) = reduced.Rest.segment<3>(3 * point).cast<float>();
    }
    for (const auto& [a, b, c] : this->Surface.triangles)
    {
      this->Triangles->InsertNextCell({ a, b, c });
    }
    this->Body = body;
  }
};

vtkStandardNewMacro(vtkPalpateTouchReducedModel);

vtkPalpateTouchReducedModel::vtkPalpateTouchReducedModel()
  : Display(std::make_unique<vtkPalpateDisplaySurface>())
{
  this->SetNumberOfInputPorts(2);
}

vtkPalpateTouchReducedModel::~vtkPalpateTouchReducedModel() = default;

void vtkPalpateTouchReducedModel::AddCoordinate(double coordinate)
{
  this->Coordinates.push_back(coordinate);
  this->Modified();
}

void vtkPalpateTouchReducedModel::ClearCoordinates()
{
  this->Coordinates.clear();
  this->Modified();
}

int vtkPalpateTouchReducedModel::FillInputPortInformation(int port, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, port == 0 ? "vtkUnstructuredGrid" : "vtkPolyData");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

int vtkPalpateTouchReducedModel::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* output = vtkPolyData::GetData(outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  const vtkMTimeType inputTime = vtkPalpateInputTime(inputVector, 1);
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&](palpate::Communicator& ranks)
    {
      if (palpate::any(ranks, !this->Cache || this->Cache->InputTime != inputTime))
      {
        this->Cache.reset();
        auto prepared = std::make_unique<Prepared>();
        prepared->InputTime = inputTime;
        palpate::agree(ranks,
          [&]
          {
            const auto body = vtkPalpateGatherBody(
              vtkPalpateInput<vtkUnstructuredGrid>(inputVector[0]), controller);
            if (body && vtkPalpatePassFailure(body, output))
            {
              // It has to be passed on in each update.
              prepared->InputTime = 0;
            }
            else if (body)
            {
              palpate::with_memory("to show the reduced body", [&] { prepared->Take(body); });
            }
          });
        this->Cache = std::move(prepared);
      }
      if (!palpate::any(ranks, this->Cache->Body != nullptr))
      {
        return;
      }
      const palpate::Surface& surface = this->Cache->Surface;
      this->Display->Take(this, inputVector[1], inputTime, controller, ranks,
        [&] {
          return vtkPalpateDisplaySurface::Carrier{ surface, {} };
        });
      palpate::agree(ranks,
        [&]
        {
          if (this->Cache->Body)
          {
            this->Show(output);
          }
          if (this->Display->IsGiven())
          {
            this->Display->Follow(output);
          }
        });
    });
  return 1;
}

void vtkPalpateTouchReducedModel::Show(vtkPolyData* output) const
{
  const Prepared& prepared = *this->Cache;
  Eigen::VectorXf y = Eigen::VectorXf::Zero(prepared.Basis.cols());
  if (!this->Coordinates.empty() && static_cast<Eigen::Index>(this->Coordinates.size()) != y.size())
  {
    throw palpate::InputError("There are " + std::to_string(this->Coordinates.size()) +
      " coordinates, but the reduced model has " + std::to_string(y.size()) +
      ". Give all of them, or none for the body at rest.");
  }
  std::copy(this->Coordinates.begin(), this->Coordinates.end(), y.begin());
  Eigen::VectorXf u = prepared.Rest;
  u.noalias() += prepared.Basis * y;
  vtkPalpateShowDisplaced(prepared.Surface, prepared.Triangles, u, output);
}

void vtkPalpateTouchReducedModel::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Coordinates:";
  for (const double coordinate : this->Coordinates)
  {
    os << ' ' << coordinate;
  }
  os << '\n';
}
