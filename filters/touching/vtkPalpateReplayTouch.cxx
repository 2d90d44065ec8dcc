// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateReplayTouch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

#include "base/error.h"
#include "base/quantity.h"
#include "base/read_file.h"
#include "vtkDelimitedTextReader.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPalpateCommunicator.h"
#include "vtkPalpateFailure.h"
#include "vtkPalpateFrameTimes.h"
#include "vtkPalpateGuard.h"
#include "vtkPalpateInput.h"
#include "vtkPalpateScene.h"
#include "vtkPalpateShownTool.h"
#include "vtkPalpateStateSpace.h"
#include "vtkPalpateTouchStateSpace.h"
#include "vtkPalpateTouchedSurface.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

namespace
{
using palpate::Vec3;

/// Numbers of palpate::ContactStatus, as they are stored.
enum ContactStatus
{
  Attached = 3,
  Pressing = 4,
  Cutting = 5
};
/// The largest number of nodes of a palpate::Contact.
constexpr int MostNodes = 3;
/// The values of a tick that are shown.
struct Frame
{
  double Time = 0;
  int Contact = 0;
  int Found = 0;
  std::array<vtkIdType, MostNodes> Nodes{ -1, -1, -1 };
  /// The bodies of the space on which these nodes are.
  std::array<vtkIdType, MostNodes> Bodies{ 1, 1, 1 };
  std::array<double, MostNodes> Weights{};
  Vec3 Displacement = Vec3::Zero();
  Vec3 Place = Vec3::Zero();
  Vec3 Force = Vec3::Zero();
  /// The area of the cut that is open, m².
  double TornArea = 0;

  /// Whether nodes are moved. They stay so while a blade is moved.
  [[nodiscard]] bool Holds() const { return this->Nodes[0] >= 0; }
};

/// The columns of a recording.
class Recording
{
public:
  /// @throws palpate::InputError the file cannot be read, or is no recording.
  explicit Recording(const std::string& fileName)
    : FileName(fileName)
  {
    if (fileName.empty())
    {
      throw palpate::InputError("No recording is named. Set FileName to a table that the dock "
                                "Palpate or palpate-servo has recorded (.csv).");
    }
    // The reader waits for ever at a pipe.
    static_cast<void>(palpate::open_to_read(fileName));
    vtkNew<vtkDelimitedTextReader> reader;
    reader->SetFileName(fileName.c_str());
    reader->SetHaveHeaders(true);
    reader->SetDetectNumericColumns(true);
    reader->SetUseStringDelimiter(true);
    reader->Update();
    this->Table = reader->GetOutput();
    this->NumberOfTicks = this->Table->GetNumberOfRows();
    this->Times = this->Column("time_s");
    if (this->NumberOfTicks == 0)
    {
      throw palpate::InputError(fileName + " holds no tick.");
    }
    for (vtkIdType i = 0; i < this->NumberOfTicks; ++i)
    {
      if (this->Number("time_s", i) < this->Times->GetValue(std::max<vtkIdType>(i - 1, 0)))
      {
        throw palpate::InputError(this->Place("time_s", i) +
          " is earlier than the one before. A recording has its ticks in the order of time: take "
          "those that are not out.");
      }
    }
  }

  [[nodiscard]] double Duration() const
  {
    return this->Times->GetValue(this->NumberOfTicks - 1) - this->Times->GetValue(0);
  }
  [[nodiscard]] std::vector<double> TickTimes() const
  {
    std::vector<double> times;
    for (vtkIdType i = 0; i < this->NumberOfTicks; ++i)
    {
      times.push_back(this->Times->GetValue(i) - this->Times->GetValue(0));
    }
    return times;
  }

  /// @throws palpate::InputError the body was another one.
  void CheckScene(const std::string& sceneHash) const
  {
    auto* settings = vtkStringArray::SafeDownCast(this->Table->GetColumnByName("settings"));
    const std::string first = settings ? settings->GetValue(0) : std::string();
    const std::string key = "scene=";
    const std::size_t at = first.find(key);
    if (at == std::string::npos)
    {
      return;
    }
    const std::string scene = first.substr(at + key.size(), first.find(';', at) - at - key.size());
    if (scene.empty())
    {
      throw palpate::InputError(this->FileName +
        " is not of a state space: a reduced model was touched, or nothing. Give Simulate Touch "
        "the recorded displacements of the tools of a reduced model as a table, as its page says.");
    }
    if (!palpate::is_same_space(scene, sceneHash))
    {
      throw palpate::InputError(this->FileName +
        " is a recording of another body. Connect the state space that was touched.");
    }
  }

  /// The last tick that is not later than a time, s from the first tick.
  [[nodiscard]] Frame At(double time) const
  {
    const double* times = this->Times->GetPointer(0);
    constexpr double rounding = 1e-7; // s
    const auto after =
      std::upper_bound(times, times + this->NumberOfTicks, times[0] + time + rounding);
    const vtkIdType i = std::max<vtkIdType>(after - times, 1) - 1;
    Frame frame;
    frame.Time = times[i] - times[0];
    frame.Contact = static_cast<int>(this->Integer("contact", i));
    frame.Found = static_cast<int>(this->Integer("found", i));
    const Vec3 anchor = this->Vector("anchor", "_m", i);
    frame.Displacement = this->Vector("displacement", "_m", i);
    frame.Force = this->Vector("body_force", "_N", i);
    for (int k = 0; k < MostNodes; ++k)
    {
      const std::string place = "_" + std::to_string(k);
      frame.Nodes[k] = this->Integer("node" + place, i);
      // Recordings of earlier versions have one body.
      if (this->Table->GetColumnByName(("body" + place).c_str()))
      {
        frame.Bodies[k] = this->Integer("body" + place, i);
      }
      frame.Weights[k] = this->Number("weight" + place, i);
    }
    // Recordings of earlier versions have no cut.
    if (this->Table->GetColumnByName("torn_area_m2"))
    {
      frame.TornArea = this->Number("torn_area_m2", i);
    }
    switch (frame.Contact)
    {
      case Attached:
      case Pressing:
        frame.Place = anchor + frame.Displacement;
        break;
      case Cutting:
        frame.Place = anchor;
        break;
      default:
        frame.Place = this->Vector("position", "_m", i);
    }
    return frame;
  }

private:
  /// @throws palpate::InputError
  vtkDoubleArray* Column(const std::string& name) const
  {
    auto& column = this->Columns[name];
    if (!column)
    {
      auto* found = vtkDataArray::SafeDownCast(this->Table->GetColumnByName(name.c_str()));
      if (!found)
      {
        throw palpate::InputError(this->FileName +
          " is no recording of the haptic loop: it has no "
          "column of numbers " +
          name + ".");
      }
      column = vtkSmartPointer<vtkDoubleArray>::New();
      column->DeepCopy(found);
    }
    return column;
  }
  [[nodiscard]] std::string Place(const std::string& name, vtkIdType i) const
  {
    return "In row " + std::to_string(i + 1) + " of " + this->FileName + " the number in " + name;
  }
  /// @throws palpate::InputError the number is not finite.
  [[nodiscard]] double Number(const std::string& name, vtkIdType i) const
  {
    const double number = this->Column(name)->GetValue(i);
    if (!std::isfinite(number))
    {
      throw palpate::InputError(this->Place(name, i) + " is not finite. Take the row out.");
    }
    return number;
  }
  /// @throws palpate::InputError the number is not one that a recording has.
  [[nodiscard]] vtkIdType Integer(const std::string& name, vtkIdType i) const
  {
    const double number = this->Number(name, i);
    if (std::trunc(number) != number || std::abs(number) > VTK_INT_MAX)
    {
      throw palpate::InputError(this->Place(name, i) + " is no whole number. Take the row out.");
    }
    return static_cast<vtkIdType>(number);
  }
  Vec3 Vector(const std::string& what, const std::string& unit, vtkIdType i) const
  {
    return { this->Number(what + "_x" + unit, i), this->Number(what + "_y" + unit, i),
      this->Number(what + "_z" + unit, i) };
  }

  std::string FileName;
  vtkSmartPointer<vtkTable> Table;
  mutable std::map<std::string, vtkSmartPointer<vtkDoubleArray>> Columns;
  vtkDoubleArray* Times = nullptr;
  vtkIdType NumberOfTicks = 0;
};

void AddFields(vtkPolyData* output, const Frame& frame)
{
  vtkNew<vtkDoubleArray> time;
  time->SetName("Time");
  time->InsertNextValue(frame.Time);
  output->GetFieldData()->AddArray(time);
  for (const auto& [name, value] :
    { std::pair("Contact", frame.Contact), { "Found", frame.Found } })
  {
    vtkNew<vtkIntArray> array;
    array->SetName(name);
    array->InsertNextValue(value);
    output->GetFieldData()->AddArray(array);
  }
}

void MakeForce(vtkPolyData* output, const Frame& frame)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->InsertNextPoint(frame.Place.data());
  vtkNew<vtkCellArray> vertex;
  vertex->InsertNextCell({ 0 });
  vtkNew<vtkDoubleArray> force;
  force->SetName("Force");
  force->SetNumberOfComponents(3);
  force->InsertNextTuple(frame.Force.data());
  output->SetPoints(points);
  output->SetVerts(vertex);
  output->GetPointData()->SetVectors(force);
}

void MoveTo(vtkPolyData* output, vtkPolyData* shape, const palpate::Pose& pose)
{
  output->ShallowCopy(shape);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType p = 0; p < shape->GetNumberOfPoints(); ++p)
  {
    const Vec3 moved = pose.in_scene(Vec3(shape->GetPoint(p)));
    points->InsertNextPoint(moved.data());
  }
  output->SetPoints(points);
}
}

struct vtkPalpateReplayTouch::Replay
{
  std::string FileName;
  std::filesystem::file_time_type Written;
  /// The recording, on rank 0.
  std::unique_ptr<Recording> Recorded;
  /// The times of the ticks, on every rank, s from the first tick.
  std::vector<double> TickTimes;

  vtkMTimeType InputTime = 0;
  vtkNew<vtkPalpateTouchStateSpace> Touch;
  /// Shows the surface in place of that of the body.
  vtkPalpateDisplaySurface Display;
  std::string SceneHash;
  /// On rank 0.
  vtkPalpateDisplaySurface::Carrier Carrier;
  bool HasRigidTool = false;
  struct Tool
  {
    /// The surface around the middle.
    vtkSmartPointer<vtkPolyData> Surface;
    palpate::PoseMapPtr Poses;
  };
  /// By body and active node, −1: the rigid tool.
  std::map<std::pair<vtkIdType, vtkIdType>, Tool> Tools;

  /// Reads the recording, on rank 0, if it is another one than before. @note Collective.
  void Read(const std::string& fileName, vtkMultiProcessController* controller,
    palpate::Communicator& ranks)
  {
    const bool reads = !controller || controller->GetLocalProcessId() == 0;
    palpate::agree(ranks,
      [&]
      {
        std::error_code missing; // Reading it says so.
        const auto written = std::filesystem::last_write_time(fileName, missing);
        if (!reads || (this->Recorded && this->FileName == fileName && this->Written == written))
        {
          return;
        }
        this->Recorded.reset();
        this->Recorded = std::make_unique<Recording>(fileName);
        this->TickTimes = this->Recorded->TickTimes();
        this->FileName = fileName;
        this->Written = written;
      });
    if (controller && controller->GetNumberOfProcesses() > 1)
    {
      auto length = static_cast<vtkIdType>(this->TickTimes.size());
      controller->Broadcast(&length, 1, 0);
      this->TickTimes.resize(static_cast<std::size_t>(length));
      controller->Broadcast(this->TickTimes.data(), length, 0);
    }
  }

  /// Takes what is shown of the tools from the space, if it is another one than before.
  /// @note Collective.
  void Take(vtkPartitionedDataSetCollection* input, vtkMultiProcessController* controller)
  {
    if (this->InputTime == input->GetMTime())
    {
      return;
    }
    const palpate::TouchSpace space = vtkPalpateSpaceFromCollection(input, controller);
    this->SceneHash = space.scene_hash;
    this->Carrier = vtkPalpateCarrierOfSpace(space, input);
    this->Tools.clear();
    this->HasRigidTool = space.find_pressing() != nullptr;
    for (const palpate::TouchToolSpace& toolSpace : space.tool_spaces)
    {
      const palpate::InteractionSpec& interaction = toolSpace.setup.interaction;
      const auto key = interaction.presses()
        ? std::pair<vtkIdType, vtkIdType>(palpate::kFirstBody, -1)
        : std::pair<vtkIdType, vtkIdType>(toolSpace.setup.body, interaction.active_node);
      const palpate::RigidTool shown = interaction.shown_shape();
      this->Tools[key] = { vtkPalpateToolSurface(shown), palpate::pose_of(shown) };
    }
    this->Touch->SetInputDataObject(input);
    this->InputTime = input->GetMTime();
  }

  /// The surface of the body in a frame. @note Collective.
  void MakeSurface(const Frame& frame, vtkMultiProcessController* controller, vtkPolyData* output)
  {
    struct Moved
    {
      vtkIdType Node = -1;
      vtkIdType Body = 1;
      double Weight = 0;
    };
    std::vector<Moved> moved;
    for (int k = 0; k < MostNodes && frame.Holds(); ++k)
    {
      if (frame.Weights[k] != 0)
      {
        moved.push_back({ frame.Nodes[k], frame.Bodies[k], frame.Weights[k] });
      }
    }
    if (moved.empty())
    {
      moved.push_back({ -1, 1, frame.Contact == Pressing ? 1.0 : 0.0 });
    }
    int number = static_cast<int>(moved.size());
    if (controller && controller->GetNumberOfProcesses() > 1)
    {
      controller->Broadcast(&number, 1, 0);
    }
    moved.resize(static_cast<std::size_t>(number));
    vtkNew<vtkFloatArray> total;
    total->SetName(vtkPalpateArray::Displacement);
    total->SetNumberOfComponents(3);
    for (const auto& [node, body, weight] : moved)
    {
      this->Touch->SetActiveNode(node);
      this->Touch->SetBodyNumber(body);
      this->Touch->SetTornArea(frame.TornArea);
      const Vec3 displacement = frame.Holds() ? frame.Displacement : Vec3(0, 0, 0);
      this->Touch->SetDisplacement(displacement[0], displacement[1], displacement[2]);
      this->Touch->SetStartDisplacement(displacement[0], displacement[1], displacement[2]);
      this->Touch->SetToolPosition(frame.Place[0], frame.Place[1], frame.Place[2]);
      // What is felt tells the branch, unless several nodes are moved, which share the force.
      const Vec3 felt = -frame.Force;
      const bool isKnown = number == 1 && weight == 1 && frame.Contact != Cutting;
      this->Touch->SetFeltForce(isKnown ? felt.data() : nullptr);
      this->Touch->Update();
      vtkPolyData* touched = this->Touch->GetOutput();
      if (vtkPalpatePassFailure(touched, output) || touched->GetNumberOfPoints() == 0)
      {
        continue;
      }
      vtkDataArray* u = touched->GetPointData()->GetArray(vtkPalpateArray::Displacement);
      if (total->GetNumberOfTuples() == 0)
      {
        total->SetNumberOfTuples(u->GetNumberOfTuples());
        total->Fill(0);
        output->ShallowCopy(touched);
        output->GetFieldData()->Initialize();
        // The points at rest.
        vtkNew<vtkPoints> points;
        for (vtkIdType p = 0; p < touched->GetNumberOfPoints(); ++p)
        {
          const Vec3 rest = Vec3(touched->GetPoint(p)) - Vec3(u->GetTuple3(p));
          points->InsertNextPoint(rest.data());
        }
        output->SetPoints(points);
      }
      for (vtkIdType i = 0; i < total->GetNumberOfValues(); ++i)
      {
        const double value = u->GetComponent(i / 3, static_cast<int>(i % 3));
        total->SetValue(i, static_cast<float>(total->GetValue(i) + weight * value));
      }
    }
    this->Finish(frame, total, output);
    if (this->Display.IsGiven() && output->GetNumberOfPoints() > 0)
    {
      this->Display.Follow(output);
    }
  }

private:
  void Finish(const Frame& frame, vtkFloatArray* displacement, vtkPolyData* output) const
  {
    if (displacement->GetNumberOfTuples() == 0)
    {
      return;
    }
    for (vtkIdType p = 0; p < output->GetNumberOfPoints(); ++p)
    {
      const Vec3 place = Vec3(output->GetPoint(p)) + Vec3(displacement->GetTuple3(p));
      output->GetPoints()->SetPoint(p, place.data());
    }
    vtkPalpateAddDisplacement(displacement, output);
    if (this->HasRigidTool && frame.Contact != Pressing)
    {
      vtkNew<vtkDoubleArray> pressure;
      pressure->SetName(vtkPalpateArray::ContactPressure);
      pressure->SetNumberOfTuples(output->GetNumberOfPoints());
      pressure->Fill(0);
      output->GetPointData()->AddArray(pressure);
    }
  }
};

vtkStandardNewMacro(vtkPalpateReplayTouch);

vtkPalpateReplayTouch::vtkPalpateReplayTouch()
  : Cache(std::make_unique<Replay>())
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(NumberOfPorts);
}

vtkPalpateReplayTouch::~vtkPalpateReplayTouch() = default;

int vtkPalpateReplayTouch::FillInputPortInformation(int port, vtkInformation* info)
{
  vtkPalpateTakeWhole(info, port == 0 ? "vtkPartitionedDataSetCollection" : "vtkPolyData");
  if (port == 1)
  {
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

std::vector<double> vtkPalpateReplayTouch::TimesToShow() const
{
  const std::vector<double>& ticks = this->Cache->TickTimes;
  if (this->FrameRate == 0 || ticks.empty())
  {
    return ticks;
  }
  std::vector<double> times;
  const double intervals = std::floor(ticks.back() * this->FrameRate);
  if (intervals >= 0 && intervals < vtkPalpateMostFrames)
  {
    for (int k = 0; k <= intervals; ++k)
    {
      times.push_back(k / this->FrameRate);
    }
  }
  return times;
}

int vtkPalpateReplayTouch::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  std::vector<double> times;
  // The execution reports what is wrong.
  vtkPalpateGuard(nullptr,
    [&]
    {
      vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
      this->Cache->Read(this->FileName, controller, *vtkPalpateCommunicator(controller));
      times = this->TimesToShow();
    });
  for (int port = 0; port < NumberOfPorts; ++port)
  {
    vtkPalpateSetTimes(times, outputVector->GetInformationObject(port));
  }
  return 1;
}

int vtkPalpateReplayTouch::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  auto* surface = vtkPolyData::GetData(outputVector, SurfacePort);
  const double time = vtkPalpateAskedTime(request, outputVector);
  vtkMultiProcessController* controller = vtkMultiProcessController::GetGlobalController();
  this->ErrorCode = vtkPalpateProduce(this, surface, controller,
    [&](palpate::Communicator& ranks)
    {
      auto* input = vtkPalpateInput<vtkPartitionedDataSetCollection>(inputVector[0]);
      if (palpate::any(ranks, vtkPalpatePassFailure(input, surface)))
      {
        return;
      }
      if (!(this->FrameRate >= 0) || !std::isfinite(this->FrameRate))
      {
        throw palpate::InputError("FrameRate is " + palpate::quantity(this->FrameRate) +
          "; it must be a number of time steps in a second, or 0 for every tick.");
      }
      Replay& replay = *this->Cache;
      replay.Read(this->FileName, controller, ranks);
      if (this->TimesToShow().empty())
      {
        throw palpate::InputError("FrameRate makes too many time steps of a recording of " +
          palpate::quantity(replay.TickTimes.back(), "s") +
          "; there may be a million. Make it smaller, or 0 for every tick.");
      }
      const bool shows = !controller || controller->GetLocalProcessId() == 0;
      Frame frame;
      palpate::agree(ranks,
        [&]
        {
          replay.Take(input, controller);
          if (shows)
          {
            replay.Recorded->CheckScene(replay.SceneHash);
            frame = replay.Recorded->At(time);
          }
        });
      replay.Display.Take(
        this, inputVector[1], replay.InputTime, controller, ranks, [&] { return replay.Carrier; });
      replay.MakeSurface(frame, controller, surface);
      if (!shows || surface->GetNumberOfPoints() == 0)
      {
        return;
      }
      auto* tool = vtkPolyData::GetData(outputVector, ToolPort);
      auto* force = vtkPolyData::GetData(outputVector, ForcePort);
      const bool isHeld = frame.Holds() || !replay.HasRigidTool;
      const auto found = replay.Tools.find(isHeld ? std::pair(frame.Bodies[0], frame.Nodes[0])
                                                  : std::pair(vtkIdType(1), vtkIdType(-1)));
      const Replay::Tool& shown =
        (found == replay.Tools.end() ? replay.Tools.begin() : found)->second;
      MoveTo(tool, shown.Surface, shown.Poses->at(frame.Place));
      MakeForce(force, frame);
      for (vtkPolyData* output : { surface, tool, force })
      {
        AddFields(output, frame);
      }
    });
  // Of each port and on each rank, and where it has failed too: what has no time would be asked for
  // again.
  for (int port = 0; port < NumberOfPorts; ++port)
  {
    vtkPolyData::GetData(outputVector, port)
      ->GetInformation()
      ->Set(vtkDataObject::DATA_TIME_STEP(), time);
  }
  return 1;
}

void vtkPalpateReplayTouch::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << '\n'
     << indent << "FrameRate: " << this->FrameRate << '\n';
}
