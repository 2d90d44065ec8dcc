// SPDX-License-Identifier: BSD-3-Clause
// The time steps of an output that is a motion from 0 to an end.
#pragma once

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "vtkDataObject.h"
#include "vtkExecutive.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkStreamingDemandDrivenPipeline.h"

/// Times that differ by less than this, in steps or frames, are the same except for rounding.
inline constexpr double vtkPalpateTimeRounding = 1e-9;

/// The largest number of time steps of a motion that may be shown.
inline constexpr double vtkPalpateMostFrames = 1e6;

/// The times of the frames, s; none if the end and the rate give none, or far too many.
inline std::vector<double> vtkPalpateFrameTimes(double endTime, double frameRate)
{
  std::vector<double> times;
  const double number = endTime * frameRate;
  if (!(endTime > 0) || !(number > 0) || !(number <= vtkPalpateMostFrames))
  {
    return times;
  }
  for (int frame = 0; frame < number * (1 - vtkPalpateTimeRounding); ++frame)
  {
    times.push_back(frame / frameRate);
  }
  times.push_back(endTime);
  return times;
}

/// @throws palpate::InputError one of the arguments gives no frames or steps, or too many.
inline void vtkPalpateCheckTimes(double endTime, double frameRate, double timeStep)
{
  const auto text = [](double number)
  {
    std::ostringstream stream;
    stream << number;
    return stream.str();
  };
  const auto require = [&](bool good, const char* name, double value, const char* unit)
  {
    if (!good)
    {
      throw palpate::InputError(
        std::string(name) + " is " + text(value) + unit + "; it must be above 0.");
    }
  };
  const auto above0 = [](double number) { return number > 0 && std::isfinite(number); };
  require(above0(endTime), "EndTime", endTime, " s");
  require(above0(frameRate), "FrameRate", frameRate, " 1/s");
  if (vtkPalpateFrameTimes(endTime, frameRate).empty())
  {
    throw palpate::InputError("EndTime and FrameRate make " + text(endTime * frameRate) +
      " time steps to be shown; there may be a million. Make one of them smaller.");
  }
  // A run of more steps would fill the memory with its table, or not end.
  constexpr double MostSteps = 1e7;
  if (timeStep > 0 && endTime > MostSteps * timeStep)
  {
    throw palpate::InputError("EndTime and TimeStep make " + text(endTime / timeStep) +
      " steps; there may be ten million. Make the steps longer, or the time shorter.");
  }
}

/// Tells the pipeline of the times.
inline void vtkPalpateSetTimes(const std::vector<double>& times, vtkInformation* info)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  info->Remove(Pipeline::TIME_STEPS());
  info->Remove(Pipeline::TIME_RANGE());
  if (times.empty())
  {
    return;
  }
  const double range[] = { times.front(), times.back() };
  info->Set(Pipeline::TIME_STEPS(), times.data(), static_cast<int>(times.size()));
  info->Set(Pipeline::TIME_RANGE(), range, 2);
}

/// The time that a request asks for, s; 0 if it asks for none.
inline double vtkPalpateAskedTime(vtkInformation* request, vtkInformationVector* outputVector)
{
  const int port = request->Has(vtkExecutive::FROM_OUTPUT_PORT())
    ? std::max(request->Get(vtkExecutive::FROM_OUTPUT_PORT()), 0)
    : 0;
  vtkInformation* info = outputVector->GetInformationObject(port);
  const auto key = vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP();
  return info->Has(key) ? info->Get(key) : 0;
}

/// The time at which the inputs were changed last.
inline vtkMTimeType vtkPalpateInputTime(vtkInformationVector** inputVector, int numberOfInputs)
{
  vtkMTimeType time = 0;
  for (int input = 0; input < numberOfInputs; ++input)
  {
    if (vtkDataObject* data = vtkDataObject::GetData(inputVector[input]))
    {
      time = std::max(time, data->GetMTime());
    }
  }
  return time;
}

/// The number of the frame that is shown at a time.
inline std::size_t vtkPalpateFrameAt(
  double time, const std::vector<double>& times, double frameRate)
{
  const auto after =
    std::upper_bound(times.begin(), times.end(), time + vtkPalpateTimeRounding / frameRate) -
    times.begin();
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(after, 1) - 1);
}
