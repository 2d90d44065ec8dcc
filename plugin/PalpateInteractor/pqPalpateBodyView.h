// SPDX-License-Identifier: BSD-3-Clause
/// The touched body in ParaView's view: a filter TouchStateSpace, on the server wherever that is,
/// which shows where a node is, or TouchReducedModel, which shows where a reduced body is. Other
/// filters can hang on it.
///
/// On a machine that does not draw fast enough edges are not smoothed as long as it touches
/// (without graphics hardware that takes more than half of the time of a frame), and the inner side
/// of an opaque body, which nobody sees, is not drawn.
#pragma once

#include <QElapsedTimer>
#include <QPointer>
#include <string>
#include <vector>

#include "pqPalpateRunWatch.h"
#include "vtkSMProxy.h"
#include "vtkWeakPointer.h"

class pqOutputPort;
class pqPipelineSource;
class pqRenderView;
class vtkSMPVRepresentationProxy;

class pqPalpateBodyView
{
public:
  /// Shows the body at rest in the place of its state space. The filter is made where there is
  /// none.
  /// @param colouredBy A point array of the filter, and the largest value that is coloured.
  /// @param inTissue See SetColours(). It counts for a filter that was made here, unless a person
  /// has
  ///   coloured it since.
  /// @param free Where a rigid tool touches nothing [3], m.
  /// @throws std::runtime_error the server does not have the filter.
  pqPalpateBodyView(pqOutputPort* space, pqRenderView* view, const char* colouredBy, double most,
    bool inTissue, const double* free);

  /// Shows a reduced body at rest.
  /// @param model The body with its reduced model.
  /// @param most The largest displacement that is coloured, m.
  pqPalpateBodyView(pqOutputPort* model, pqRenderView* view, double most, bool inTissue);

  /// @param inTissue At rest the body has the colour of tissue; else the map is that of ParaView.
  void SetColours(bool inTissue);

  pqPipelineSource* GetFilter() const { return this->Filter; }

  /// @param node -1: the first of the space.
  /// @param branch That the body is on there.
  /// @param displacement Of the node [3], m.
  void Show(int node, int branch, const double* displacement);
  /// @param place Of a rigid tool [3], m.
  void ShowPressed(const double* place);
  /// @param coordinates Of a reduced body, all of them; none: it is at rest.
  /// @param number Of them.
  void ShowReduced(const double* coordinates, unsigned int number);
  /// At the end: the whole picture of the view, and the body at rest, as far as they are there.
  void Leave(pqPalpateRunWatch::Left left);
  void ShowRest();
  /// Draws the view.
  void Draw();
  /// There is nothing to draw now: the next frame is not late.
  void Rest() { this->LastFrame = -1; }
  quint64 GetNumberOfFrames() const { return this->NumberOfFrames; }
  /// Frames in the last second.
  double GetFrameRate();

private:
  /// Nothing is left out any more.
  void RestorePicture();
  void SetRest();
  /// All that is shown is up to date.
  bool IsKnown() const;
  /// The filter's properties have become others.
  /// @param isKnown All was up to date before.
  void Take(vtkSMProxy* filter, bool isKnown);
  /// What has changed are the body's places alone: ParaView need not ask again, for each property
  /// of each representation, which arrays there are. That takes it longer than to draw them.
  void KeepDomains();
  /// Leaves out what costs most and is seen least when frames come too late.
  void KeepPace();
  void LeaveOut(vtkSMProxy* proxy, const char* property, int value);

  /// @param filter The name of the one that shows the body.
  pqPalpateBodyView(pqOutputPort* space, pqRenderView* view, const char* filter,
    const char* colouredBy, double most, bool inTissue, const double* free);
  /// The legend says what is coloured, in letters that are seen whatever is behind it.
  void SetLegend();
  /// How the filter is shown in the view; null: it is not.
  vtkSMPVRepresentationProxy* FindShown() const;

  /// Not of a reduced body.
  double Free[3] = { 0, 0, 0 };
  bool IsReduced;
  std::string ColouredBy;
  double Most;
  QPointer<pqPipelineSource> Filter;
  QPointer<pqRenderView> View;
  struct Omission
  {
    vtkWeakPointer<vtkSMProxy> Proxy;
    const char* Property;
    int Before;
  };
  std::vector<Omission> Omissions;
  QElapsedTimer Time;
  /// When the last frames were, ms.
  std::vector<qint64> Frames;
  quint64 NumberOfFrames = 0;
  qint64 LastFrame = -1;
  int LateFrames = 0;
  bool IsOver = false;
};
