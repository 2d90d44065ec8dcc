// SPDX-License-Identifier: BSD-3-Clause
/// The touched body in ParaView's view: a filter TouchStateSpace, on the server wherever that is,
/// which shows where a node is. Other filters can hang on it.
///
/// A machine that does not draw fast enough gets a plainer picture as long as it touches.
#pragma once

#include <QElapsedTimer>
#include <QPointer>
#include <vector>

class pqOutputPort;
class pqPipelineSource;
class pqRenderView;

class pqPalpateBodyView
{
public:
  /// Shows the body at rest in the place of its state space. The filter is made where there is none.
  /// @param halfWidth The largest displacement that is coloured, m.
  /// @throws std::runtime_error the server does not have the filter.
  pqPalpateBodyView(pqOutputPort* space, pqRenderView* view, double halfWidth);

  pqPipelineSource* GetFilter() const { return this->Filter; }

  /// @param node -1: the first of the space.
  /// @param branch That the body is on there.
  /// @param displacement Of the node [3], m.
  void Show(int node, int branch, const double* displacement);
  void ShowRest();
  /// Gives the view all of its picture back.
  void RestorePicture();
  /// Draws the view.
  void Draw();
  /// There is nothing to draw now: the next frame is not late.
  void Rest() { this->LastFrame = -1; }
  quint64 GetNumberOfFrames() const { return this->NumberOfFrames; }
  /// Frames in the last second.
  double GetFrameRate();

private:
  void SetRest();
  /// Leaves out what costs most of the picture when frames come too late.
  void KeepPace();

  QPointer<pqPipelineSource> Filter;
  QPointer<pqRenderView> View;
  /// What of the picture was left out, and what it was before.
  std::vector<int> LeftOut;
  QElapsedTimer Time;
  /// When the last frames were, ms.
  std::vector<qint64> Frames;
  quint64 NumberOfFrames = 0;
  qint64 LastFrame = -1;
  int LateFrames = 0;
  bool IsOver = false;
};
