// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateSegmentationReader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "vtkDataArraySelection.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateImageFile.h"
#include "vtkPalpateSegments.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

vtkStandardNewMacro(vtkPalpateSegmentationReader);

namespace
{
using palpate::InputError;

/// Sets size, spacing, origin and directions.
void Place(const vtkPalpateImageHeader& header, vtkImageData* image)
{
  image->SetDimensions(header.Size.data());
  image->SetOrigin(header.Origin.data());
  std::array<double, 3> spacing{};
  std::array<double, 9> directions{};
  for (int axis = 0; axis < 3; ++axis)
  {
    spacing[axis] = vtkMath::Norm(header.Axes[axis].data());
    for (int c = 0; c < 3; ++c)
    {
      // Adding 0 makes -0 a 0.
      directions[3 * c + axis] = header.Axes[axis][c] / spacing[axis] + 0.0;
    }
  }
  image->SetSpacing(spacing.data());
  image->SetDirectionMatrix(directions.data());
}

template <class Array, class Value>
void AddVoxels(const char* name, const std::vector<Value>& values, vtkImageData* image)
{
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfValues(static_cast<vtkIdType>(values.size()));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  image->GetPointData()->SetScalars(array);
}

void AddSegments(const std::vector<vtkPalpateSegment>& segments, const std::vector<char>& chosen,
  const vtkPalpateJoinedSegments& joined, vtkFieldData* fields)
{
  vtkNew<vtkStringArray> names;
  names->SetName("Segment");
  vtkNew<vtkIntArray> labels;
  labels->SetName("SegmentLabel");
  vtkNew<vtkDoubleArray> colors;
  colors->SetName("SegmentColor");
  colors->SetNumberOfComponents(3);
  vtkNew<vtkDoubleArray> voxels;
  voxels->SetName("SegmentVoxels");
  vtkNew<vtkDoubleArray> lost;
  lost->SetName("SegmentLost");
  for (std::size_t i = 0; i < segments.size(); ++i)
  {
    if (chosen[i])
    {
      names->InsertNextValue(segments[i].Name);
      labels->InsertNextValue(segments[i].Label);
      colors->InsertNextTuple(segments[i].Color.data());
      voxels->InsertNextValue(static_cast<double>(joined.Voxels[i]));
      lost->InsertNextValue(static_cast<double>(joined.Lost[i]));
    }
  }
  for (vtkAbstractArray* array :
    std::initializer_list<vtkAbstractArray*>{ names, labels, colors, voxels, lost })
  {
    fields->AddArray(array);
  }
}

/// A text about the parts of the segments that are not in the labels; empty if all are.
std::string TellLost(const std::vector<vtkPalpateSegment>& segments,
  const vtkPalpateJoinedSegments& joined, double voxel)
{
  std::ostringstream text;
  const auto tell = [&text, voxel](std::size_t count) {
    text << count << " voxels (" << static_cast<double>(count) * voxel << " mm³ of a file in mm)";
  };
  for (std::size_t i = 0; i < segments.size(); ++i)
  {
    if (joined.Lost[i] > 0)
    {
      text << (text.tellp() == 0
                  ? "Segments overlap, and where they do the later one in the file's "
                    "order is taken: '"
                  : "; '")
           << segments[i].Name << "' loses ";
      tell(joined.Lost[i]);
      text << " of its " << joined.Voxels[i];
    }
  }
  text << (text.tellp() == 0 ? ""
                             : ". Switch one of them off under Segments to have the other "
                               "whole. ");
  if (joined.Unnamed > 0)
  {
    tell(joined.Unnamed);
    text << " have a value that belongs to no segment of the file; they are left out. ";
  }
  return text.str();
}

std::string TellHeader(const vtkPalpateImageHeader& header)
{
  std::string text;
  if (!header.Oriented)
  {
    text += "The file does not say in LPS, RAS or LAS where its axes point to: they are taken to "
            "point to the left, the back and the head as they are, and what it shows may lie "
            "otherwise. ";
  }
  if (!header.Unit.empty() && header.Unit != "mm" && header.Unit != "millimeter")
  {
    text += "The file is in '" + header.Unit +
      "' and not in mm: choose that as the Unit of Tetrahedralize Label Map. ";
  }
  return text;
}
}

vtkPalpateSegmentationReader::vtkPalpateSegmentationReader()
{
  this->SetNumberOfInputPorts(0);
}

vtkPalpateSegmentationReader::~vtkPalpateSegmentationReader() = default;

void vtkPalpateSegmentationReader::AddSegment(const char* name, int isRead)
{
  this->Chosen[name] = isRead != 0;
  this->Modified();
}

void vtkPalpateSegmentationReader::ClearSegments()
{
  this->Chosen.clear();
  this->Modified();
}

vtkDataArraySelection* vtkPalpateSegmentationReader::GetSegments()
{
  return this->Segments;
}

bool vtkPalpateSegmentationReader::IsRead(const std::string& segment) const
{
  const auto found = this->Chosen.find(segment);
  return this->Chosen.empty() || (found != this->Chosen.end() && found->second);
}

int vtkPalpateSegmentationReader::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkPalpateImageFile image;
  std::vector<vtkPalpateSegment> segments;
  try
  {
    image.Header = vtkPalpateReadImageHeader(this->FileName);
    segments = vtkPalpateFindSegments(image.Header);
    vtkPalpateArrangeImage(image);
  }
  catch (const std::exception&)
  {
    // Let RequestData run, which reports the error.
    image.Header.Size = { 1, 1, 1 };
  }
  this->Segments->RemoveAllArrays();
  for (const auto& segment : segments)
  {
    this->Segments->AddArray(segment.Name.c_str(), this->IsRead(segment.Name));
  }
  const auto& size = image.Header.Size;
  const std::array<int, 6> extent = { 0, size[0] - 1, 0, size[1] - 1, 0, size[2] - 1 };
  vtkInformation* information = outputVector->GetInformationObject(0);
  information->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data(), 6);
  information->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  return 1;
}

int vtkPalpateSegmentationReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  auto* output = vtkImageData::GetData(outputVector);
  output->Initialize();
  if (this->ErrorCode != 0 && this->FailureTime == this->GetMTime())
  {
    vtkPalpateMarkFailed(output, this->Failure.c_str());
    return 1;
  }
  auto* controller = vtkMultiProcessController::GetGlobalController();
  const bool tells = !controller || controller->GetLocalProcessId() == 0;
  this->ErrorCode = vtkPalpateProduce(tells ? this : nullptr, output, nullptr,
    [&]
    {
      this->Read(output, tells);
      output->Crop(
        vtkStreamingDemandDrivenPipeline::GetUpdateExtent(outputVector->GetInformationObject(0)));
    });
  this->Failure = vtkPalpateFailureOf(output);
  this->FailureTime = this->GetMTime();
  return 1;
}

void vtkPalpateSegmentationReader::Read(vtkImageData* output, bool tells)
{
  if (this->FileName.empty())
  {
    throw InputError(
      "No file is named. Set FileName to a .nrrd, .nhdr, .mha, .mhd, .nii or .nii.gz file.");
  }
  vtkPalpateImageFile image = vtkPalpateReadImageFile(this->FileName, {});
  const std::vector<vtkPalpateSegment> segments = vtkPalpateFindSegments(image.Header);
  if (segments.empty() && image.Header.Components != 1)
  {
    throw InputError("The file " + this->FileName + " has " +
      std::to_string(image.Header.Components) +
      " values for each voxel, and tells of no segments: it is an image of colours or vectors, and "
      "no segmentation.");
  }
  vtkPalpateArrangeImage(image);
  std::string warning = TellHeader(image.Header);
  Place(image.Header, output);
  const std::vector<char> chosen = this->Choose(segments);
  if (!segments.empty())
  {
    const auto joined = vtkPalpateJoinSegments(image, segments, chosen);
    AddVoxels<vtkIntArray>("Labels", joined.Labels, output);
    AddSegments(segments, chosen, joined, output->GetFieldData());
    warning += TellLost(segments, joined, image.Header.Volume());
  }
  else if (image.Values.empty())
  {
    AddVoxels<vtkIntArray>("Labels", image.Labels, output);
  }
  else
  {
    AddVoxels<vtkDoubleArray>("Values", image.Values, output);
  }
  if (tells && !warning.empty())
  {
    vtkPalpateWarn(this, "The file " + this->FileName + ": " + warning);
  }
}

std::vector<char> vtkPalpateSegmentationReader::Choose(
  const std::vector<vtkPalpateSegment>& segments) const
{
  std::vector<char> chosen;
  std::string names;
  for (const auto& segment : segments)
  {
    chosen.push_back(this->IsRead(segment.Name) ? 1 : 0);
    names += (names.empty() ? "'" : ", '") + segment.Name + '\'';
  }
  const std::string there = segments.empty() ? "It has none." : "It has: " + names + '.';
  for (const auto& [name, isRead] : this->Chosen)
  {
    const bool isThere = std::any_of(segments.begin(), segments.end(),
      [&name = name](const auto& segment) { return segment.Name == name; });
    if (isRead && !isThere)
    {
      throw InputError(
        "Segments has '" + name + "', but the file has no segment of that name. " + there);
    }
  }
  if (!segments.empty() &&
    std::none_of(chosen.begin(), chosen.end(), [](char one) { return one != 0; }))
  {
    throw InputError("Segments has none of the file switched on. " + there);
  }
  return chosen;
}

void vtkPalpateSegmentationReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << '\n' << indent << "Segments:";
  for (const auto& [name, isRead] : this->Chosen)
  {
    os << ' ' << name << '=' << isRead;
  }
  os << '\n';
}
