// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateCutPlane.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/quantity.h"
#include "base/types.h"
#include "vtkCommunicator.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCutSheet.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPlaneSource.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkPalpateCutPlane);

namespace
{
using palpate::InputError;
using palpate::Vec3;

/// How far the sheet goes beyond the body, as a share of the body's diagonal.
constexpr double Beyond = 0.05;
/// A direction along the plane that is shorter than this share of a direction is none.
constexpr double NoDirection = 1e-6;
constexpr int Resolution = 20;

/// The box around the points of all ranks. @note Collective.
Eigen::AlignedBox3d BoundsOfAll(vtkPointSet* body, vtkMultiProcessController* controller)
{
  Eigen::AlignedBox3d box;
  if (body && body->GetNumberOfPoints() > 0)
  {
    double bounds[6];
    body->GetBounds(bounds);
    box.extend(Vec3(bounds[0], bounds[2], bounds[4]));
    box.extend(Vec3(bounds[1], bounds[3], bounds[5]));
  }
  if (controller && controller->GetNumberOfProcesses() > 1)
  {
    Vec3 low = box.min();
    Vec3 high = box.max();
    controller->AllReduce(low.data(), box.min().data(), 3, vtkCommunicator::MIN_OP);
    controller->AllReduce(high.data(), box.max().data(), 3, vtkCommunicator::MAX_OP);
  }
  return box;
}
}

void vtkPalpateCutPlane::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const auto print = [&](const char* name, const double* v, const char* unit)
  { os << indent << name << ": " << v[0] << ' ' << v[1] << ' ' << v[2] << unit << "\n"; };
  print("Origin", this->Origin, " m");
  print("Normal", this->Normal, "");
  print("CutDirection", this->CutDirection, "");
  os << indent << "Width: " << this->Width << " m\n";
}

int vtkPalpateCutPlane::FillInputPortInformation(int, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, "vtkPointSet");
  return 1;
}

int vtkPalpateCutPlane::RequestData(
  vtkInformation*, vtkInformationVector** input, vtkInformationVector* outputs)
{
  auto* output = vtkPolyData::GetData(outputs);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, output, controller,
    [&]
    {
      const Eigen::AlignedBox3d box =
        BoundsOfAll(vtkPalpateInput<vtkPointSet>(input[0]), controller);
      if (box.isEmpty())
      {
        throw InputError("The body has no points.");
      }
      const Vec3 end(this->Origin);
      const Vec3 normal = Vec3(this->Normal).stableNormalized();
      if (!end.allFinite() || !(normal.norm() > 0.5) || !Vec3(this->CutDirection).allFinite())
      {
        throw InputError("Origin, Normal and CutDirection must be finite, and Normal not 0 0 0.");
      }
      if (!(this->Width >= 0) || !std::isfinite(this->Width))
      {
        throw InputError(
          "Width is " + palpate::quantity(this->Width, "m") + ", but must be a length, or 0.");
      }
      const double diagonal = box.diagonal().norm();
      const bool isGiven = !Vec3(this->CutDirection).isZero(0);
      const Vec3 wanted =
        isGiven ? Vec3(this->CutDirection).stableNormalized() : Vec3(box.center() - end) / diagonal;
      Vec3 along = wanted - normal * normal.dot(wanted);
      if (along.norm() < NoDirection)
      {
        if (isGiven)
        {
          throw InputError("CutDirection is along the normal of the plane. Choose a direction "
                           "along the plane, or 0 0 0.");
        }
        along = normal.unitOrthogonal();
      }
      along.normalize();
      const Vec3 across = normal.cross(along);
      double begin = std::numeric_limits<double>::infinity();
      double low = begin;
      double high = -begin;
      for (int corner = 0; corner < 8; ++corner)
      {
        const Vec3 x = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - end;
        begin = std::min(begin, along.dot(x));
        low = std::min(low, across.dot(x));
        high = std::max(high, across.dot(x));
      }
      if (begin >= 0)
      {
        throw InputError("The cut ends at " + palpate::quantity(end, "m") +
          ", before it comes to the body. Move Origin into the body, or turn CutDirection.");
      }
      begin -= Beyond * diagonal;
      low = this->Width > 0 ? -0.5 * this->Width : low - Beyond * diagonal;
      high = this->Width > 0 ? 0.5 * this->Width : high + Beyond * diagonal;
      if (controller && controller->GetLocalProcessId() > 0)
      {
        return;
      }
      Vec3 corner = end + begin * along + low * across;
      Vec3 ahead = end + low * across;
      Vec3 aside = end + begin * along + high * across;
      vtkNew<vtkPlaneSource> plane;
      plane->SetOrigin(corner.data());
      plane->SetPoint1(ahead.data());
      plane->SetPoint2(aside.data());
      plane->SetResolution(Resolution, Resolution);
      plane->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
      plane->Update();
      output->ShallowCopy(plane->GetOutput());
      vtkNew<vtkDoubleArray> front;
      front->SetName(vtkPalpateFrontOfSheet);
      for (vtkIdType p = 0; p < output->GetNumberOfPoints(); ++p)
      {
        front->InsertNextValue(along.dot(Vec3(output->GetPoint(p)) - corner));
      }
      output->GetPointData()->AddArray(front);
    });
  return 1;
}
