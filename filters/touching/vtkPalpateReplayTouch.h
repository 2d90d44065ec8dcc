// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkPalpateReplayTouch
 * @brief a recorded touch as a time series: the deforming body, the tool, and the force on it
 *
 * Input: the state space that was touched (see vtkPalpateStateSpace.h). The file is a recording of
 * the haptic loop, a table of every tick (haptic/recording/columns.h). Three outputs, each a
 * vtkPolyData at the time that is asked for, in s from the first tick:
 *
 *   Surface   of the body, deformed as it was shown: the point arrays `Displacement` (m) and
 *             `Normals`, and `ContactPressure` (Pa) where the space has a rigid tool
 *   Tool      its surface, where it was: that of the rigid tool, or a sphere of the tip's radius
 *   Force     a vertex at the middle of the tool, with the point array `Force`: that of the body on
 *             the tool, N
 *
 * With a second input, a surface of the same organ, the first output is that surface, carried by
 * the body, with its own arrays too.
 *
 * The outputs have the field arrays `Time` (s), `Contact` (numbers of palpate::ContactStatus) and
 * `Found` (of palpate::Support). A tick in which several active nodes were moved shows their
 * weighted mean, as the loop felt it. In a space with levels the body is shown on that of its
 * branches at a place whose force is nearest to the recorded one; where several nodes were moved,
 * on those that it reaches on a straight way from rest.
 *
 * Under MPI the result is whole on rank 0 and empty elsewhere.
 */
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "PalpateTouchingModule.h"
#include "vtkPolyDataAlgorithm.h"

class PALPATETOUCHING_EXPORT vtkPalpateReplayTouch : public vtkPolyDataAlgorithm
{
public:
  static vtkPalpateReplayTouch* New();
  vtkTypeMacro(vtkPalpateReplayTouch, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /// The recording (.csv).
  vtkSetStdStringFromCharMacro(FileName);
  vtkGetCharFromStdStringMacro(FileName);
  ///@}
  ///@{
  /// Time steps in a second, not negative; 0: every tick.
  vtkSetMacro(FrameRate, double);
  vtkGetMacro(FrameRate, double);
  ///@}

protected:
  vtkPalpateReplayTouch();
  ~vtkPalpateReplayTouch() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkPalpateReplayTouch(const vtkPalpateReplayTouch&) = delete;
  void operator=(const vtkPalpateReplayTouch&) = delete;

  enum OutputPort
  {
    SurfacePort,
    ToolPort,
    ForcePort,
    NumberOfPorts
  };

  struct Replay;

  /// The times to be shown, s from the first tick; none if FrameRate gives far too many.
  [[nodiscard]] std::vector<double> TimesToShow() const;

  std::string FileName;
  double FrameRate = 25;

  std::unique_ptr<Replay> Cache;
};
