// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateTetGenProcess.h"

#include <sys/wait.h>

#include <cstring>
#include <sstream>
#include <vector>

#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLImageDataWriter.h"
#include "vtkXMLPolyDataWriter.h"
#include "vtkXMLUnstructuredGridReader.h"

#include "base/find_program.h"
#include "vtkPalpateProgram.h"

namespace
{
using palpate::BackendError;

template <class Writer>
std::string ToText(vtkDataObject* data)
{
  vtkNew<Writer> writer;
  writer->SetInputData(data);
  // The data are not appended, since recent releases of Expat make VTK's reader refuse that.
  writer->SetDataModeToBinary();
  writer->SetCompressorTypeToNone();
  writer->WriteToOutputStringOn();
  writer->Write();
  return writer->GetOutputString();
}

/// The grid in a text; null if the text is not a grid of the promised form.
vtkSmartPointer<vtkUnstructuredGrid> FromText(const std::string& text)
{
  constexpr std::size_t enough_to_tell = 400;
  if (text.substr(0, enough_to_tell).find("<VTKFile") == std::string::npos)
  {
    return nullptr;
  }
  bool failed = false;
  vtkNew<vtkCallbackCommand> on_error;
  on_error->SetClientData(&failed);
  on_error->SetCallback(
    [](vtkObject*, unsigned long, void* data, void*) { *static_cast<bool*>(data) = true; });
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->AddObserver(vtkCommand::ErrorEvent, on_error);
  reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, on_error);
  reader->SetParserErrorObserver(on_error);
  reader->ReadFromInputStringOn();
  reader->SetInputString(text);
  reader->Update();
  vtkSmartPointer<vtkUnstructuredGrid> grid = reader->GetOutput();
  const bool complete = !failed && grid && grid->GetNumberOfCells() > 0 &&
    vtkIntArray::SafeDownCast(grid->GetCellData()->GetArray("Marker"));
  return complete ? grid : nullptr;
}

std::string Exact(double value)
{
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

std::vector<std::string> Arguments(const vtkPalpateTetGenOptions& options)
{
  std::vector<std::string> arguments = { "--ratio", Exact(options.MaximumRadiusEdgeRatio) };
  if (options.MaximumVolume > 0)
  {
    arguments.insert(arguments.end(), { "--volume", Exact(options.MaximumVolume) });
  }
  if (options.Region && options.RegionVolume > 0)
  {
    arguments.insert(arguments.end(), { "--region-volume", Exact(options.RegionVolume) });
  }
  if (options.PreserveSurface)
  {
    arguments.emplace_back("--preserve");
  }
  return arguments;
}
}

vtkPalpateTetGenLimits::vtkPalpateTetGenLimits(
  double timeOut, const std::function<void(double)>& progress)
{
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  // A time of more than a year is no limit, and would overflow the clock.
  constexpr double year = 3e7;
  if (timeOut > 0 && timeOut < year)
  {
    this->Deadline =
      start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(timeOut));
  }
  this->Poll = [progress, start]
  {
    // The guess reaches one half at this time, s.
    constexpr double half_way = 10;
    const double time = std::chrono::duration<double>(Clock::now() - start).count();
    progress(time / (half_way + time));
  };
}

vtkSmartPointer<vtkUnstructuredGrid> vtkPalpateRunTetGen(vtkPolyData* surface,
  const vtkPalpateTetGenOptions& options, const vtkPalpateTetGenLimits& limits)
{
  const std::string program =
    palpate::find_program("palpate-tetgen", "PALPATE_TETGEN", "Build it (PALPATE_WITH_TETGEN)");
  vtkPalpateNamelessFile input, region, mesh, errors;
  input.Write(ToText<vtkXMLPolyDataWriter>(surface));
  if (options.Region)
  {
    region.Write(ToText<vtkXMLImageDataWriter>(options.Region));
  }

  const auto status = vtkPalpateRunProgram(
    program, Arguments(options), { &input, &mesh, &errors, &region }, limits.Deadline, limits.Poll);
  if (!status)
  {
    throw BackendError("TetGen did not finish within TimeOut and was stopped. Ask for larger "
                       "tetrahedra, or raise MaximumRadiusEdgeRatio or TimeOut. " +
      vtkPalpateLastWords(errors));
  }
  if (WIFSIGNALED(*status))
  {
    throw vtkPalpateTetGenFailure("TetGen crashed (signal " + std::to_string(WTERMSIG(*status)) +
      ", " + strsignal(WTERMSIG(*status)) + "). " + vtkPalpateLastWords(errors));
  }
  if (WEXITSTATUS(*status) != 0)
  {
    throw vtkPalpateTetGenFailure("TetGen failed (exit code " +
      std::to_string(WEXITSTATUS(*status)) + "). " + vtkPalpateLastWords(errors));
  }
  auto result = FromText(mesh.Read());
  if (!result)
  {
    throw BackendError(
      "palpate-tetgen (" + program + ") gave no readable mesh. " + vtkPalpateLastWords(errors));
  }
  return result;
}
